# cmake --install: headers, modules, programs, and the package that find_package(softkin CONFIG) finds.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/softkin)

# The headers for users; all others stay inside.
include(${CMAKE_CURRENT_LIST_DIR}/public_headers.cmake)
foreach(header ${softkin_public_headers} ${softkin_included_headers})
  get_filename_component(folder softkin/${header} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/src/softkin/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder})
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

install(TARGETS softkin_settings softkin_core softkin_linear softkin_model softkin_io softkin_energy softkin_contact
        softkin_statics softkin_kinematics softkin_drive softkin_calibration softkin_runs softkin_all EXPORT softkin
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT softkin NAMESPACE softkin:: FILE softkin-targets.cmake DESTINATION ${package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/softkin-config.cmake.in softkin-config.cmake
                              INSTALL_DESTINATION ${package_dir})
# until 1.0 any release may change what a program sees
write_basic_package_version_file(softkin-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/softkin-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/softkin-config-version.cmake
        DESTINATION ${package_dir})

install(TARGETS softkin_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
if(SOFTKIN_OPENCV_FOUND)
  install(TARGETS softkin_measure RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

# The examples that `softkin examples` finds in share, in a folder above the program: of a build they are the sources' own.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/softkin)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/examples ${PROJECT_BINARY_DIR}/share/softkin/examples SYMBOLIC)
function(softkin_install_examples share)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/ DESTINATION ${share}/softkin/examples ${ARGN}
          PATTERN cpp EXCLUDE PATTERN python EXCLUDE PATTERN __pycache__ EXCLUDE)
endfunction()
softkin_install_examples(share)
