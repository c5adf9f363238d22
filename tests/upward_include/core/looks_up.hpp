#pragma once

#include <softkin/model/mesh/mesh.hpp>  // an upward include, which tests/check_rooms.cmake must report
