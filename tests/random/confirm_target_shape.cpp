#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <limits>

#include "random/confirm.hpp"

/// One step of Algorithm 1 of the paper, with the deviations of docs/paper.md, from the answer: dense matrices,
/// singular value decompositions, no code of the solver.
namespace softkin::random_robots {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
/// An SVD is as near as this to one with another best rotation [-].
constexpr double tie = 1e-7;
/// Steps over the tolerance that an answer may still have ahead, and units in the last place lost in the linear system.
constexpr double max_steps = 5, lost = 64;
constexpr double min_ratio = 0.01;  // of an actuation element

using Shape = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // a point a row

/// An element of Eq. (9): its nodes are sums of vertices.
struct Element {
  std::vector<EmbeddedPoint> nodes;
  Shape current, target;  // centred; the target not yet turned
  double weight = 0;
  bool has_soft = false;
  double scale_current = 0;  // of the current shape in the soft target
};

Shape centred(const Shape& shape) {
  return shape.rowwise() - shape.colwise().mean();
}

Shape shape_at(const std::vector<EmbeddedPoint>& nodes, const Points& positions) {
  Shape shape(nodes.size(), 3);
  for (std::size_t i = 0; i < nodes.size(); ++i) shape.row(i) = nodes[i].at(positions).transpose();
  return shape;
}

template <class Nodes>
std::vector<EmbeddedPoint> vertices(const Nodes& nodes) {
  std::vector<EmbeddedPoint> points;
  for (const Index v : nodes) points.push_back({{v}, {1.0}, 0});
  return points;
}

Vec3 row(const Shape& shape, Index i) {
  return shape.row(i).transpose();
}

/// Signed, of a tetrahedron, or of a prism with bilinear sides.
double volume(const Shape& p) {
  const auto triple = [&](Index a, Index b, Index c) {
    return (row(p, a) - row(p, 0)).dot((row(p, b) - row(p, 0)).cross(row(p, c) - row(p, 0)));
  };
  if (p.rows() == 4) return triple(1, 2, 3) / 6;
  double six = triple(3, 4, 5);
  for (Index i = 0; i < 3; ++i) {
    const Index j = (i + 1) % 3;
    six += (triple(i, j, j + 3) + triple(i, j + 3, i + 3) + triple(i, j, i + 3) + triple(j, j + 3, i + 3)) / 2;
  }
  return six / 6;
}

double area(const Shape& p, Index first) {
  return (row(p, first + 1) - row(p, first)).cross(row(p, first + 2) - row(p, first)).norm() / 2;
}

/// What the actuator of an element controls.
double measure(const Actuator& actuator, const Shape& p) {
  if (actuator.is<CableDrive>()) return (row(p, 1) - row(p, 0)).norm();
  return actuator.is<ChamberDrive>() ? volume(p) : (area(p, 0) + area(p, 3)) / 2;
}

Shape cable_target(const Shape& rest, double ratio) {
  const Vec3 along = (row(rest, 1) - row(rest, 0)).normalized();
  Shape target = rest;
  for (Index i = 0; i < 3; ++i) target.row(i) += (ratio - 1) * row(rest, i).dot(along) * along.transpose();
  return target;
}

Shape layer_target(const Shape& rest, double ratio) {
  Vec3 normal = Vec3::Zero();
  for (Index t = 0; t < 6; t += 3) normal += (row(rest, t + 1) - row(rest, t)).cross(row(rest, t + 2) - row(rest, t));
  normal.normalize();
  Shape target = rest;
  for (Index t = 0; t < 6; t += 3) {
    const Vec3 center = (row(rest, t) + row(rest, t + 1) + row(rest, t + 2)) / 3;  // rest is centred
    const Vec3 moved = center + (1 / ratio - 1) * center.dot(normal) * normal;
    for (Index i = t; i < t + 3; ++i) target.row(i) = (moved + std::sqrt(ratio) * (row(rest, i) - center)).transpose();
  }
  return target;
}

/// Target of Eqs. (6) to (8), not yet turned.
Shape actuated(const Actuator& actuator, const Shape& rest, double ratio) {
  if (actuator.is<CableDrive>()) return cable_target(rest, ratio);
  return actuator.is<ChamberDrive>() ? Shape(std::cbrt(ratio) * rest) : layer_target(rest, ratio);
}

/// A third of the squared distances of the corners from their centre, by those from each other.
double squared_size(const Shape& rest) {
  double sum = 0;
  for (Index i = 0; i < rest.rows(); ++i)
    for (Index j = 0; j < i; ++j) sum += (rest.row(i) - rest.row(j)).squaredNorm();
  return sum / (3.0 * static_cast<double>(rest.rows()));
}

double weight_of(const Model& model, const Shape& rest, double by_volume) {
  return model.weights == ElementWeights::printed ? by_volume : by_volume / squared_size(rest);
}

struct Elements {
  std::vector<Element> all;

  void add_body(const Model& model, const Points& positions, const std::vector<EmbeddedPoint>& nodes,
                const Material& material) {
    Element element{nodes, centred(shape_at(nodes, positions)), centred(shape_at(nodes, model.rest))};
    const double at_rest = volume(element.target), ratio = volume(element.current) / at_rest;
    element.weight = weight_of(model, element.target, material.weight * at_rest);
    const double soft = 1 - material.shape_ratio;
    // below an eighth of its volume the soft target turns into the rigid one
    const double whole = std::clamp(8 * ratio, 0.0, 1.0);
    element.scale_current = soft * whole / std::cbrt(std::max(ratio, 1e-6));
    element.target *= material.shape_ratio + soft * (1 - whole);
    element.has_soft = soft > 0;
    all.push_back(std::move(element));
  }

  void add_actuator(const Model& model, const Points& positions, const Actuator& actuator, double command,
                    const std::vector<std::vector<EmbeddedPoint>>& parts, const std::vector<double>& weights) {
    double sum = 0, fractions = 0, now = 0;
    // alike where the mesh must not matter; how many gaps a cable has does not depend on the mesh
    const bool alike = model.weights == ElementWeights::mesh_independent && !actuator.is<CableDrive>();
    const auto fraction = [alike](double measure) { return alike ? 1 : measure; };
    std::vector<double> at_rest, ratios;
    for (const auto& nodes : parts) {
      at_rest.push_back(measure(actuator, shape_at(nodes, model.rest)));
      const double current = measure(actuator, shape_at(nodes, positions));
      ratios.push_back(current / at_rest.back());
      sum += at_rest.back();
      fractions += fraction(at_rest.back()) * at_rest.back();
      now += current;
    }
    // a cable's pieces inside the body keep their length
    const double requested = command * actuator.rest_measure - (actuator.rest_measure - sum);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const double even = requested / sum;
      const double free = actuator.distribution == Distribution::uniform ? even
                          : actuator.distribution == Distribution::minimum_norm
                              ? ratios[i] + fraction(at_rest[i]) * (requested - now) / fractions
                          : now > 0 ? ratios[i] * requested / now
                                    : even;
      Element element{parts[i], centred(shape_at(parts[i], positions)),
                      actuated(actuator, centred(shape_at(parts[i], model.rest)), std::max(min_ratio, free))};
      element.weight = weight_of(model, shape_at(parts[i], model.rest), actuator.weight * weights[i]);
      all.push_back(std::move(element));
    }
  }
};

double mean_body_volume(const Model& model) {
  double sum = 0, count = 0;
  const auto add = [&](const std::vector<ElementRole>& roles, const std::vector<double>& volumes) {
    for (std::size_t e = 0; e < roles.size(); ++e)
      if (roles[e].material >= 0) sum += volumes[e], ++count;
  };
  add(model.elements.tetrahedron_roles, model.elements.tetrahedron_volumes);
  add(model.elements.prism_roles, model.elements.prism_volumes);
  return count > 0 ? sum / count : 1;
}

/// What an actuator is; empty: it is of another kind.
template <class Kind>
Kind part_of(const Actuator& actuator) {
  const auto* is = actuator.as<Kind>();
  return is ? *is : Kind{};
}

Elements elements_of(const Model& model, const Equilibrium& found) {
  const Points& positions = found.state.positions;
  Elements elements;
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e)
    if (const Index m = model.elements.tetrahedron_roles[e].material; m >= 0)
      elements.add_body(model, positions, vertices(model.elements.tetrahedra[e]), model.elements.materials[m]);
  for (std::size_t e = 0; e < model.elements.prisms.size(); ++e)
    if (const Index m = model.elements.prism_roles[e].material; m >= 0)
      elements.add_body(model, positions, vertices(model.elements.prisms[e]), model.elements.materials[m]);
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    std::vector<std::vector<EmbeddedPoint>> parts;
    std::vector<double> weights;
    const auto cable = part_of<CableDrive>(actuator);
    for (const CableGap& gap : cable.gaps) {
      parts.push_back({cable.points[gap.segment], cable.points[gap.segment + 1], gap.apex});
      const double edge =
          std::sqrt(3 * squared_size(shape_at(parts.back(), model.rest)));  // of as large an equilateral one
      weights.push_back(model.weights == ElementWeights::printed ? mean_body_volume(model)
                                                                 : edge * edge * edge / (6 * std::sqrt(2.0)));
    }
    for (const Index e : part_of<ChamberDrive>(actuator).tetrahedra) {
      parts.push_back(vertices(model.elements.tetrahedra[e]));
      weights.push_back(model.elements.tetrahedron_volumes[e]);
    }
    for (const Index e : part_of<DeaDrive>(actuator).prisms) {
      parts.push_back(vertices(model.elements.prisms[e]));
      weights.push_back(model.elements.prism_volumes[e]);
    }
    elements.add_actuator(model, positions, actuator, found.state.actuation[a], parts, weights);
  }
  return elements;
}

/// Columns: how the vertices move with each unknown: free axes, slides and turns of rigid regions.
Eigen::MatrixXd moves_by_unknowns(const Model& model, const Points& positions) {
  const Index rows = 3 * static_cast<Index>(model.rest.rows());
  std::vector<Eigen::VectorXd> columns;
  std::vector<bool> of_rigid(model.elements.used.size());
  for (const RigidRegion& region : model.rigid) {
    const RigidMoves moves = moves_of(model, region);
    Vec3 middle = Vec3::Zero();
    for (const Index v : region.vertices) {
      of_rigid[v] = true;
      middle += positions.row(v).transpose() / static_cast<double>(region.vertices.size());
    }
    for (int axis = 0; axis < 3; ++axis)
      for (const bool turn : {false, true}) {
        if (!(turn ? moves.turns : moves.slides)[axis]) continue;
        Eigen::VectorXd& column = columns.emplace_back(Eigen::VectorXd::Zero(rows));
        for (const Index v : region.vertices)
          column.segment<3>(3 * v) =
              turn ? Vec3(Vec3::Unit(axis).cross(positions.row(v).transpose() - middle) / model.diagonal_mm)
                   : Vec3(Vec3::Unit(axis));
      }
  }
  for (Index v = 0; v < model.rest.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (!model.held.fixed[v][axis] && !of_rigid[v]) {
        columns.emplace_back(Eigen::VectorXd::Zero(rows));
        columns.back()[3 * v + axis] = 1;
      }
  Eigen::MatrixXd all(rows, columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) all.col(i) = columns[i];
  return all;
}

/// The matrix of Eq. (10) for one coordinate, the forces on the vertices, and bounds of the rounding errors in them.
struct Step {
  Eigen::MatrixXd matrix;
  Points pull, blur;
  bool undecided = false;

  explicit Step(Index count)
      : matrix(Eigen::MatrixXd::Zero(count, count)), pull(Points::Zero(count, 3)), blur(Points::Zero(count, 3)) {}

  void add(const Element& element) {
    const Eigen::JacobiSVD<Mat3> svd(element.current.transpose() * element.target,
                                     Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double proper = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    const Vec3 values = svd.singularValues();
    if (values[1] + proper * values[2] < tie * values[0]) undecided = true;
    const Mat3 rotation = svd.matrixU() * Vec3(1, 1, proper).asDiagonal() * svd.matrixV().transpose();
    const Shape wanted = element.target * rotation.transpose() + element.scale_current * element.current;
    const Index k = element.nodes.size();
    const double size = std::max(element.current.norm(), element.target.norm());
    for (Index i = 0; i < k; ++i) {
      const EmbeddedPoint& a = element.nodes[i];
      for (std::size_t n = 0; n < a.vertices.size(); ++n) {
        pull.row(a.vertices[n]) += element.weight * a.weights[n] * (wanted.row(i) - element.current.row(i));
        blur.row(a.vertices[n]).array() += element.weight * a.weights[n] * size;
        for (Index j = 0; j < k; ++j) {
          const EmbeddedPoint& b = element.nodes[j];
          const double n_ij = (i == j ? 1.0 : 0.0) - 1.0 / static_cast<double>(k);
          for (std::size_t m = 0; m < b.vertices.size(); ++m)
            matrix(a.vertices[n], b.vertices[m]) += element.weight * n_ij * a.weights[n] * b.weights[m];
        }
      }
    }
  }
};

void check_held(const Model& model, const State& state, Confirmation& out) {
  const Points& positions = state.positions;
  const Points places = held_places(model, state);
  const double far = std::max(model.rest.cwiseAbs().maxCoeff(), positions.cwiseAbs().maxCoeff());
  double worst = 0;
  for (Index v = 0; v < model.rest.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (model.held.fixed[v][axis]) worst = std::max(worst, std::abs(positions(v, axis) - places(v, axis)));
  if (!(worst <= 1e-9 * model.diagonal_mm + 64 * epsilon * far))
    out.faults.push_back("a held vertex is " + digits(worst) + " mm from its place");
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (state.multipliers.size() > 0 && state.multipliers[a] != 0)
      out.faults.push_back("'" + model.actuators[a].name + "' has a multiplier, and target shapes know no loads");
  worst = 0;
  for (const RigidRegion& region : model.rigid)
    for (std::size_t i = 0; i < std::min<std::size_t>(4, region.vertices.size()); ++i)
      for (const Index v : region.vertices) {
        const Index u = region.vertices[i];
        worst = std::max(worst, std::abs((positions.row(v) - positions.row(u)).norm() -
                                         (model.rest.row(v) - model.rest.row(u)).norm()));
      }
  if (!(worst <= 1e-9 * model.diagonal_mm + 64 * epsilon * far))
    out.faults.push_back("a rigid region has changed its shape by " + digits(worst) + " mm");
}

}  // namespace

void confirm_target_shape(const Model& model, const Equilibrium& found, Confirmation& out) {
  const Points& positions = found.state.positions;
  check_held(model, found.state, out);
  Step step(model.rest.rows());
  for (const Element& element : elements_of(model, found).all) step.add(element);
  out.undecided = step.undecided;

  const Eigen::MatrixXd moves = moves_by_unknowns(model, positions);
  if (moves.cols() == 0) return;
  const Index count = model.rest.rows();
  Eigen::MatrixXd spread(3 * count, moves.cols());  // the matrix times each column
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Map<const Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, 3>> of_axis(
        moves.data() + axis, count, moves.cols(), Eigen::Stride<Eigen::Dynamic, 3>(3 * count, 3));
    Eigen::Map<Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, 3>>(spread.data() + axis, count, moves.cols(),
                                                                     Eigen::Stride<Eigen::Dynamic, 3>(3 * count, 3)) =
        step.matrix * of_axis;
  }
  const Eigen::MatrixXd normal = moves.transpose() * spread;
  const Eigen::LDLT<Eigen::MatrixXd> factor(normal);
  const Eigen::Map<const Eigen::VectorXd> pull(step.pull.data(), 3 * count), blur(step.blur.data(), 3 * count);
  const auto largest = [&](const Eigen::VectorXd& unknowns) {
    const Eigen::VectorXd by_vertex = moves * unknowns;
    return Eigen::Map<const Points>(by_vertex.data(), count, 3).rowwise().norm().maxCoeff();
  };
  const double far = std::max(model.rest.cwiseAbs().maxCoeff(), positions.cwiseAbs().maxCoeff());
  const double moved = largest(factor.solve(moves.transpose() * pull));
  const double hidden = lost * epsilon *
                        (far + largest(factor.solve(moves.cwiseAbs().transpose() * blur)) +
                         far / model.diagonal_mm * largest(factor.solve(moves.cwiseAbs().transpose() * blur)));
  const double tolerance = found.report.tolerance_mm;
  out.blurred = hidden > 1e3 * tolerance;
  if (hidden < tolerance) out.step_ratio = moved / tolerance;
  if (!step.undecided && !(moved <= max_steps * tolerance + hidden))
    out.faults.push_back("a step of Algorithm 1 still moves it by " + digits(moved) + " mm, tolerance " +
                         digits(tolerance) + " mm, rounding " + digits(hidden) + " mm");
}

}  // namespace softkin::random_robots
