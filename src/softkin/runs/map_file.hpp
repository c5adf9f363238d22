#pragma once

#include <filesystem>
#include <softkin/kinematics/map.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <string_view>

namespace softkin::runs {

/// A map on disk: a line of JSON with the position of each array, and the arrays behind it; docs/maps.md has the
/// layout.
[[nodiscard]] std::string map_bytes(const MapData& data);
void write_map(const std::filesystem::path& path, const MapData& data);

/// throws  InvalidInput naming the file: it is none, of a newer softkin, cut off or broken
[[nodiscard]] MapData read_map(const std::filesystem::path& path);
/// file_name: for messages
[[nodiscard]] MapData map_from_bytes(std::string_view bytes, const std::string& file_name);

/// throws  InvalidInput naming the difference: the map is of another robot, or of this one before a change
void check_robot(const MapData& data, const Model& model, const std::string& file_name);

/// "36 equilibria; checked at 200 points: tip within 0.00018 mm, ..." and what it refused, a line each.
[[nodiscard]] std::string map_text(const MapData& data);

/// The same as JSON. seconds: that it took to make
[[nodiscard]] std::string map_json(const MapData& data, const std::string& file_name, double seconds);

}  // namespace softkin::runs
