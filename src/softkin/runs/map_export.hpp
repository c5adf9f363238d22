#pragma once

#include <softkin/kinematics/map.hpp>

namespace softkin::runs {

/// A map for programs without softkin; docs/maps.md explains its use. Each export checks itself against answers of the
/// map that it contains.

enum class CNumbers { doubles, floats };

/// A header of C99 that includes nothing: outputs, their Jacobian, inverse kinematics. Not the whole shape.
///
/// throws  InvalidInput where the map has no answer at random commands to check itself with
[[nodiscard]] std::string map_c_header(const MapData& data, CNumbers numbers);

/// What names in the header begin with: "three_chamber".
[[nodiscard]] std::string c_name(const MapData& data);

/// An ES module: the same, and the whole shape if the map has it.
///
/// throws  as map_c_header(), and InvalidInput where softkin was built without its page
[[nodiscard]] std::string map_js_module(const MapData& data);
/// Its types, for TypeScript.
[[nodiscard]] std::string map_js_types(const MapData& data);

/// All arrays of the map, as numpy.load reads them (.npz).
[[nodiscard]] std::string map_npz(const MapData& data);

}  // namespace softkin::runs
