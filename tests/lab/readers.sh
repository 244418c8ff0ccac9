# SPDX-License-Identifier: Apache-2.0
# Sourced: readers of a CAN interface, waited for however long they take to start.
# readers INTERFACE: how many sockets the kernel hands its frames to. listens INTERFACE [COUNT]: until it is so many.
readers() { grep -c "^ *$1 " /proc/net/can/rcvlist_all || true; }
listens() { for _ in $(seq 600); do [ "$(readers "$1")" -ge "${2:-1}" ] && return 0; sleep 0.1; done; fail "no reader on $1"; }
