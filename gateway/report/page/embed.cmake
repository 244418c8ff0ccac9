# SPDX-License-Identifier: Apache-2.0
# Writes OUT: the files FILES as string constants, in order, for html.cpp.
set(script "")
set(style "")
foreach(file IN LISTS FILES)
  file(READ ${file} content)
  # Raw strings of a compiler have a size limit; pieces are joined by the compiler again.
  if(file MATCHES "\\.css$")
    set(style "${content}")
  else()
    string(APPEND script ")js\"\nR\"js(${content}")
  endif()
endforeach()
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT [[
// SPDX-License-Identifier: Apache-2.0
#include "gateway/report/page/page_files.hpp"

namespace servogate::report {
const char* const kPageStyle = R"css(@style@)css";
const char* const kPageScript = R"js(@script@)js";
}  // namespace servogate::report
]])
