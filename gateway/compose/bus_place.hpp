// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace servogate::gateway {

/// Where the bus of a url is, in one way of writing for all processes of this computer: paths whole and
/// without links, hosts as numbers, channels said; a lockstep bus is that of its server. Of what is no url:
/// itself. Not real-time safe.
std::string bus_place(std::string_view url);

/// Whether two places (bus_place()) are the same bus, as far as can be told from outside: an adapter that is
/// named by "any" may be every one.
bool same_place(std::string_view a, std::string_view b);

}  // namespace servogate::gateway
