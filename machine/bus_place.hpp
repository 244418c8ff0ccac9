// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace servogate::machine {

/// Where the bus or line of a url is, in one way of writing for all processes of this computer: paths whole
/// and without links, hosts as numbers, channels said; a lockstep bus is that of its server. Of what is no
/// url: itself. Not real-time safe.
std::string bus_place(std::string_view url);

/// Whether two places (bus_place()) are the same bus, as far as can be told from outside: an adapter that is
/// named by "any" may be every one.
bool same_place(std::string_view a, std::string_view b);

/// The same of two urls. Names of hosts are looked up only where scheme and name are equal. Not real-time
/// safe.
bool same_bus(std::string_view url, std::string_view other);

}  // namespace servogate::machine
