#pragma once

#include <filesystem>
#include <softkin/model/measured_poses.hpp>

namespace softkin {

/// Gives poses the outlines of the robot in their pictures: a table picture,x_mm,y_mm [mm], as softkin measure writes
/// it, the points of a picture one after another along its outline, which may have gaps.
///
/// throws  InvalidInput naming file, line and column: poses without a column of pictures, or of none; a picture of
///         theirs that the table does not have; other columns, a picture without a number, fewer than 8 points of one
void add_outlines(MeasuredPoses& poses, const std::filesystem::path& file);

}  // namespace softkin
