# Libraries that softkin is built on, those that are missing in one message.
set(missing "")
foreach(need "Eigen3 3.4 NO_MODULE;libeigen3-dev" "yaml-cpp;libyaml-cpp-dev" "nlohmann_json;nlohmann-json3-dev"
        "pugixml;libpugixml-dev" "ZLIB;zlib1g-dev" "PNG;libpng-dev" "CLI11;libcli11-dev" "nanoflann;libnanoflann-dev"
        "Qhull;libqhull-dev" "Boost 1.74;libboost-dev")
  list(GET need 0 what)
  list(GET need 1 package)
  separate_arguments(what)
  find_package(${what} QUIET)
  list(GET what 0 name)
  if(NOT ${name}_FOUND)
    list(APPEND missing ${package})
  endif()
endforeach()
find_path(SOFTKIN_METIS metis.h)
if(NOT SOFTKIN_METIS)
  list(APPEND missing libmetis-dev)
endif()
if(missing)
  list(JOIN missing " " missing)
  message(FATAL_ERROR "softkin is built on libraries that are not installed here; as root run\n"
                      "  apt-get install --no-install-recommends ${missing}\n"
                      "(Debian 12, Ubuntu 24.04; elsewhere the packages with their headers), or take a wheel, which needs none.")
endif()
find_package(Threads REQUIRED)
