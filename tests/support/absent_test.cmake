# Lists the test NAME as skipped for REASON, as tests/support/main.cpp does for a test of a program.
if(DEFINED ENV{SOFTKIN_SKIPPED})
  file(APPEND $ENV{SOFTKIN_SKIPPED} "${NAME}: ${REASON}\n")
endif()
if(DEFINED ENV{SOFTKIN_NO_SKIP})
  message(FATAL_ERROR "${NAME} cannot run, where SOFTKIN_NO_SKIP forbids it: ${REASON}")
endif()
message("skipped: ${REASON}")
