// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <readerwriterqueue/readerwriterqueue.h>

#include "kernel/cycle/executive.hpp"

namespace servogate::cycle {

/// The two queues between the cycle and the one thread that speaks for everybody outside. Sized once; the
/// cycle only uses the calls that never allocate.
struct Cycle::Queues {
  moodycamel::ReaderWriterQueue<image::Request> requests{256};
  moodycamel::ReaderWriterQueue<image::Answer> answers{256};
};

}  // namespace servogate::cycle
