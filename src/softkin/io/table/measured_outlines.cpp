#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/measured_outlines.hpp>
#include <softkin/io/table/measured_poses.hpp>

namespace softkin {

namespace {

constexpr std::size_t min_outline_points = 8;

using OutlinesByPicture = std::map<Index, std::vector<Eigen::Vector2d>>;

OutlinesByPicture read_outlines(const CsvTable& table) {
  const auto column = [&](const char* name) {
    const std::optional<std::size_t> found = table.find(name);
    if (!found)
      table.fail_header(std::string("column '") + name + "' is missing: an outline has picture, x_mm and y_mm");
    return *found;
  };
  const std::size_t picture = column(picture_column), x = column("x_mm"), y = column("y_mm");
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (c != picture && c != x && c != y)
      table.fail_header("column " + excerpt(table.columns[c]) + ": an outline has picture, x_mm and y_mm alone");
  OutlinesByPicture outlines;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const double number = table.rows[row][picture];
    if (!(number >= 1 && number <= max_pictures && number == std::floor(number)))
      table.fail(row, std::string("column '") + picture_column + "': expected the number of a picture, 1 or more");
    const Eigen::Vector2d point(table.rows[row][x], table.rows[row][y]);
    std::vector<Eigen::Vector2d>& points = outlines[static_cast<Index>(number)];
    if (points.empty() || points.back() != point) points.push_back(point);
  }
  for (auto& [number, points] : outlines) {
    if (points.back() == points.front()) points.pop_back();  // closed by its first point
    if (points.size() < min_outline_points)
      table.fail_header("picture " + std::to_string(number) + " has " + counted(points.size(), "point") +
                        ": an outline has " + std::to_string(min_outline_points) + " different ones at least");
  }
  return outlines;
}

}  // namespace

void add_outlines(MeasuredPoses& poses, const std::filesystem::path& file) {
  if (poses.pictures.empty())
    throw InvalidInput({poses.file}, std::string("no column '") + picture_column +
                                         "', which says of each pose the picture of its outline");
  if (std::none_of(poses.pictures.begin(), poses.pictures.end(), [](Index number) { return number > 0; }))
    throw InvalidInput({poses.file}, std::string("column '") + picture_column + "': no pose has a picture");
  const OutlinesByPicture outlines = read_outlines(read_csv(file));
  poses.outlines.file = file.string();
  poses.outlines.points.assign(poses.commands.size(), {});
  for (std::size_t pose = 0; pose < poses.pictures.size(); ++pose) {
    if (poses.pictures[pose] == 0) continue;
    const auto found = outlines.find(poses.pictures[pose]);
    if (found == outlines.end())
      throw InvalidInput({.file = poses.file, .line = poses.lines[pose]},
                         std::string("column '") + picture_column + "': there is no picture " +
                             std::to_string(poses.pictures[pose]) + " in " + file.string());
    poses.outlines.points[pose] = found->second;
  }
}

}  // namespace softkin
