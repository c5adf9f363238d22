#pragma once

// What most programs need: read a scene, compile it, solve it, ask back what the shape measures. docs/cpp.md
#include <softkin/core/error.hpp>
#include <softkin/core/version.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/scene/scene.hpp>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/jacobian.hpp>
#include <softkin/kinematics/trajectory.hpp>
#include <softkin/kinematics/workspace.hpp>
#include <softkin/model/magnetic_field.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/jobs.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/statics.hpp>
