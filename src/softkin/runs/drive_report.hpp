#pragma once

#include <softkin/drive/marlin_link.hpp>
#include <softkin/drive/plan.hpp>
#include <string>

namespace softkin::runs {

/// The report of softkin drive, JSON.
///
/// scene   its file, as the user named it
/// whole   with the program and the schedule
/// stream  how the program was sent; null: it was not
[[nodiscard]] std::string drive_report(const std::string& scene, const drive::Plan& plan, bool whole,
                                       const drive::StreamReport* stream);

}  // namespace softkin::runs
