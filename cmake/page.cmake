# softkin_page(TARGET): compiles the page of apps/view/web into it, as embedded_page(), and of it the code of exported
# maps, as embedded_map_script(); both empty where there is no npm or its registry cannot be reached, which the build
# says. Nothing is written into the sources.
function(softkin_page target)
  set(web ${PROJECT_SOURCE_DIR}/apps/view/web)
  set(embedded ${PROJECT_BINARY_DIR}/page/embedded_page.cpp)
  set(make_page ${PROJECT_SOURCE_DIR}/cmake/make_page.cmake)
  find_program(SOFTKIN_NPM npm)
  set(files)
  if(EXISTS ${web}/package.json)
    file(GLOB_RECURSE files CONFIGURE_DEPENDS ${web}/*)
    list(FILTER files EXCLUDE REGEX "^${web}/(node_modules|dist)/")
    if(NOT SOFTKIN_NPM)
      message(STATUS "npm not found: no pages (--html, view) and no modules of maps (map export --js)")
    endif()
  endif()
  # depends on whether there is an npm as well as on the files
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/page/npm.txt CONTENT "@SOFTKIN_NPM@\n")
  add_custom_command(
    OUTPUT ${embedded}
    COMMAND ${CMAKE_COMMAND} -DWEB=${web} -DNPM=${SOFTKIN_NPM} -DFOLDER=${PROJECT_BINARY_DIR}/page -DOUTPUT=${embedded}
            -P ${make_page}
    DEPENDS ${make_page} ${files} ${PROJECT_BINARY_DIR}/page/npm.txt
    COMMENT "Building the page" VERBATIM)
  target_sources(${target} PRIVATE ${embedded})
  set_source_files_properties(${embedded} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON
                              COMPILE_OPTIONS -Wno-overlength-strings)
endfunction()
