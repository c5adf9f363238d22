# Adds an entry of CTest for each test suite of a program, so that a failure names the suite. CTest includes this file
# through those that softkin_suites() writes, which set:
#   name                 begin of the entries' names
#   command              the test program, after an emulator where one is needed
#   filter               pattern of GoogleTest that selects the tests
#   labels, properties   of the entries
execute_process(COMMAND ${command} --gtest_list_tests --gtest_filter=${filter}
                OUTPUT_VARIABLE listed ERROR_QUIET RESULT_VARIABLE failed)
if(failed)  # it is not built: its entry fails
  add_test(${name} ${command})
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" ${properties})
  return()
endif()
# a suite and its tests in one line each: "Suite. First Second"
string(REGEX REPLACE " *#[^\n]*" "" listed "${listed}")  # values of parameters
string(REGEX REPLACE "\n +" " " listed "${listed}")
string(STRIP "${listed}" listed)
string(REPLACE "\n" ";" listed "${listed}")
foreach(line IN LISTS listed)
  string(REPLACE " " ";" tests "${line}")
  list(POP_FRONT tests suite)
  list(TRANSFORM tests PREPEND ${suite})
  list(JOIN tests ":" tests)
  string(REGEX REPLACE "\\.$" "" suite ${suite})
  add_test(${name}.${suite} ${command} --gtest_filter=${tests})
  set_tests_properties(${name}.${suite} PROPERTIES LABELS "${labels}" ${properties})
endforeach()
