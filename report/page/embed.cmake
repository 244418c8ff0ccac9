# SPDX-License-Identifier: Apache-2.0
# Writes OUT: the files FILES as string constants for html.cpp, files of one kind joined in their order.
foreach(kind IN ITEMS style body script libraries notices)
  set(${kind} "")
endforeach()
foreach(file IN LISTS FILES)
  file(READ ${file} content)
  if(file MATCHES "\\.css$")
    set(kind style)
  elseif(file MATCHES "\\.html$")
    set(kind body)
  elseif(file MATCHES "\\.txt$")
    set(kind notices)
  elseif(file MATCHES "/vendor/")
    set(kind libraries)
  else()
    set(kind script)
  endif()
  # Raw strings of a compiler have a size limit; pieces are joined by the compiler again.
  string(APPEND ${kind} ")page\"\nR\"page(${content}")
endforeach()
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT [[
// SPDX-License-Identifier: Apache-2.0
#include "report/page/page_files.hpp"

namespace servogate::report {
const char* const kPageStyle = R"page(@style@)page";
const char* const kPageBody = R"page(@body@)page";
const char* const kPageScript = R"page(@script@)page";
const char* const kPageLibraries = R"page(@libraries@)page";
const char* const kPageNotices = R"page(@notices@)page";
}  // namespace servogate::report
]])
