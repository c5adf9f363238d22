#pragma once

#include <softkin/io/json_text.hpp>
#include <softkin/runs/records.hpp>

namespace softkin::runs {

/// What a step of a report has of the physical formulation alone: forces, stability, stress, contacts.
[[nodiscard]] Json physical_json(const Model& model, const StepRecord& record);
/// throws  Json::exception and std::out_of_range on what physical_json() of the same model does not write
void read_physical(const Model& model, const Json& json, StepRecord& record);

}  // namespace softkin::runs
