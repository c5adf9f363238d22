# Builds the page of WEB with NPM in FOLDER, and writes it and the code of exported maps to OUTPUT as C++
# (cmake/page.cmake).
set(page ${FOLDER}/web/dist/page.html)
set(map_script ${FOLDER}/web/dist/exported_map.js)

# installed: of which lock file, once all of it is there
set(installed ${FOLDER}/installed-package-lock.json)

function(install_packages)
  set(lock ${FOLDER}/web/package-lock.json)
  if(EXISTS ${installed} AND EXISTS ${FOLDER}/web/node_modules)
    file(SHA256 ${installed} before)
    file(SHA256 ${lock} now)
    if(before STREQUAL now)
      return()
    endif()
  endif()
  file(REMOVE ${installed})
  execute_process(COMMAND ${NPM} ci --omit=dev --no-audit --no-fund --fetch-retries=1 WORKING_DIRECTORY ${FOLDER}/web
                  RESULT_VARIABLE failed OUTPUT_VARIABLE told ERROR_VARIABLE told TIMEOUT 300)
  if(failed)
    message("${told}")
    message(WARNING "npm could not install what the page needs (above): softkin is built without pages (--html, view) "
                    "and modules of maps (map export --js). Once npm's registry can be reached, remove ${OUTPUT} and "
                    "build again.")
  else()
    configure_file(${lock} ${installed} COPYONLY)
  endif()
endfunction()

function(build_page)
  # beside what npm installed before
  file(GLOB old LIST_DIRECTORIES true ${FOLDER}/web/*)
  list(FILTER old EXCLUDE REGEX "/node_modules$")
  if(old)
    file(REMOVE_RECURSE ${old})
  endif()
  file(COPY ${WEB}/ DESTINATION ${FOLDER}/web PATTERN node_modules EXCLUDE PATTERN dist EXCLUDE)
  install_packages()
  if(NOT EXISTS ${installed})
    return()
  endif()
  execute_process(COMMAND ${NPM} run build WORKING_DIRECTORY ${FOLDER}/web
                  RESULT_VARIABLE failed OUTPUT_VARIABLE told ERROR_VARIABLE told)
  if(failed OR NOT EXISTS ${page} OR NOT EXISTS ${map_script})
    message(FATAL_ERROR "${told}\nthe page (${WEB}) could not be built")
  endif()
endfunction()

# embedded(NAME FILE): adds to ${functions} one that gives the text of a file; of one that is not there, none
function(embedded name file)
  set(hex "")
  if(EXISTS ${file})
    file(READ ${file} hex HEX)
    # lines of 64 bytes, each byte as \xAB
    string(REPEAT "." 128 line)
    string(REGEX REPLACE "(${line})" "\\1\n" hex "${hex}")
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" hex "${hex}")
    string(REPLACE "\n" "\"\n    \"" hex "${hex}")
  endif()
  string(CONCAT functions "${functions}std::string_view ${name}();\n\nstd::string_view ${name}() {\n"
      "  static constexpr char text[] =\n    \"${hex}\";\n  return {text, sizeof text - 1};\n}\n\n")
  set(functions "${functions}" PARENT_SCOPE)
endfunction()

file(REMOVE ${page} ${map_script})
if(NPM AND EXISTS ${WEB}/package.json)
  build_page()
endif()
embedded(embedded_page ${page})
embedded(embedded_map_script ${map_script})
file(WRITE ${OUTPUT}
     "#include <string_view>\n\nnamespace softkin::runs {\n\n${functions}}  // namespace softkin::runs\n")
