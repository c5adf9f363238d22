#pragma once

#include <softkin/model/mesh/mesh.hpp>  // the core may not see the model: tests/check_rooms.cmake must say so
