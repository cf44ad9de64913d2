# No instruction of the library fuses a product with a sum: a build for this machine rounds as one for any x86-64.
# Arguments: OBJDUMP, LIBRARY.
execute_process(COMMAND ${OBJDUMP} -d ${LIBRARY} COMMAND grep -E "file format|vfn?m(add|sub)" OUTPUT_VARIABLE lines)
string(REGEX MATCHALL "[^\n]+\\.o: +file format [^\n]*\n[^\n]*\tvfn?m(add|sub)[^\n]*" fused "${lines}")
string(REGEX MATCHALL "\\.o: +file format" objects "${lines}")
list(LENGTH objects count)
if(count EQUAL 0)
  message(FATAL_ERROR "${LIBRARY}: ${OBJDUMP} shows no object")
endif()
if(fused)
  list(JOIN fused "\n" fused)
  message(FATAL_ERROR "fused products, the first of each object:\n${fused}\n"
    "g++: add the source to the list `alternating` in CMakeLists.txt. Eigen: include granular/core/math.h before it.")
endif()
message(STATUS "${count} objects, none with fused products")
