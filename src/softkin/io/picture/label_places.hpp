#pragma once

#include <Eigen/Core>
#include <vector>

namespace softkin {

/// A part of the picture [pixel], y down.
struct Area {
  Eigen::Vector2d low, high;
};

/// What a label names, and how large it is [pixel]; width 0: there is none.
struct LabelWish {
  Eigen::Vector2d at;
  double width = 0, height = 0;
};

/// The point of an area that is nearest to a place.
[[nodiscard]] Eigen::Vector2d nearest_in(const Area& area, const Eigen::Vector2d& place);

/// Upper left corners of labels beside what they name: at the first of some places, nearest ones first, at which a
/// label covers no other one and nothing that is taken and is inside the picture; where there is none, at that of least
/// overlap.
///
/// taken  such as the marks themselves
/// unit   distances are multiples of it [pixel]
[[nodiscard]] std::vector<Eigen::Vector2d> label_places(const std::vector<LabelWish>& wishes,
                                                        const std::vector<Area>& taken, const Area& picture,
                                                        double unit);

}  // namespace softkin
