cmake_minimum_required(VERSION 3.22)

# Fails where an object compiled for one instruction set defines what the linker may take for all of the program:
# inline functions and templates that do not bear the name of the target or of its vectors. On a processor without these
# instructions the program would end there.
#   cmake -DNM=nm -DTARGET=avx2 -DBYTES=32 -DOBJECTS=a.o,b.o -P check_kernels.cmake
string(REPLACE "," ";" OBJECTS "${OBJECTS}")
set(count 0)
foreach(object ${OBJECTS})
  execute_process(COMMAND ${NM} --demangle --defined-only ${object} OUTPUT_VARIABLE symbols RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "${NM} could not read ${object}")
  endif()
  string(REGEX REPLACE "\n" ";" symbols "${symbols}")
  foreach(symbol ${symbols})
    math(EXPR count "${count} + 1")
    if(symbol MATCHES "^[0-9a-f]+ [WVu] " AND NOT symbol MATCHES "::${TARGET}::|Eigen_${TARGET}::|(Pack|Mask)Of<${BYTES}>")
      message(SEND_ERROR "${object}: ${symbol}")
    endif()
  endforeach()
endforeach()
if(count EQUAL 0)
  message(FATAL_ERROR "no symbols found")
endif()
message(STATUS "${count} symbols checked")
