#pragma once

#include <memory>
#include <softkin/io/scene/tree.hpp>
#include <string>

namespace softkin::scene {

/// A scene with one value changed, or given where it has none.
///
/// change  PATH=VALUE. A path is of keys, and of entries of lists by their name, their region or their number from 1,
///         with dots between: materials.body.youngs_modulus=0.8, actuators.air.range.2=60. A value is YAML.
/// option  that gives it, for messages, also those of a value that is wrong
/// within  what every path is within: "materials", or ""
/// throws  InvalidInput naming option and change: there is no such entry (with the nearest one), or several
[[nodiscard]] std::shared_ptr<const Node> changed(const std::shared_ptr<const Node>& root, const std::string& option,
                                                  const std::string& change, const std::string& within);

/// The number at such a path.
///
/// throws  InvalidInput naming option and path: as changed(), or there is no number
[[nodiscard]] double number_at(const std::shared_ptr<const Node>& root, const std::string& option,
                               const std::string& path);

}  // namespace softkin::scene
