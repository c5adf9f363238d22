#pragma once

#include <array>
#include <optional>
#include <softkin/model/model.hpp>
#include <softkin/runs/records_json.hpp>
#include <softkin/statics/contact_forces.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// A list; null where it was not measured.
[[nodiscard]] Json contacts_json(const Model& model, const std::optional<std::vector<PairForces>>& contacts);

/// Pairs with slip, as [on, by]: there derivatives are those for continued sliding.
[[nodiscard]] std::vector<std::array<std::string, 2>> sliding_pairs(
    const Model& model, const std::optional<std::vector<PairForces>>& contacts);

/// throws  std::out_of_range and Json::exception on what contacts_json() does not write
[[nodiscard]] std::vector<PairForces> contacts_of(const Model& model, const Json& list);

/// The anchors of sticking friction: vertex, part, triangle, weights of its corners, and the slip vector [mm], of each.
[[nodiscard]] Json anchors_json(const std::vector<Anchor>& anchors);
/// throws  std::out_of_range where the model has no such place
[[nodiscard]] std::vector<Anchor> anchors_of(const Model& model, const Json& list);

}  // namespace softkin::runs
