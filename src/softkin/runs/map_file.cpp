#include <algorithm>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/core/version.hpp>
#include <softkin/io/file.hpp>
#include <softkin/kinematics/maps/piece_solver.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/map_file.hpp>

namespace softkin::runs {

namespace {

constexpr int format = 1;
constexpr std::size_t alignment = 8;  // of arrays, from the begin of the file

static_assert(std::endian::native == std::endian::little, "arrays of a map are little-endian");

/// The arrays behind the header, each described by its position.
class Arrays {
 public:
  /// Row by row.
  template <class Matrix>
  nlohmann::ordered_json add(const char* type, const Matrix& matrix) {
    using Scalar = typename Matrix::Scalar;
    nlohmann::ordered_json reported{{"type", type}, {"at", bytes_.size()}, {"shape", {matrix.rows(), matrix.cols()}}};
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
      for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
        const Scalar value = matrix(i, j);
        bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
    bytes_.resize((bytes_.size() + alignment - 1) / alignment * alignment);
    return reported;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class ArrayReader {
 public:
  explicit ArrayReader(std::string_view bytes) : bytes_(bytes) {}

  template <class Matrix>
  [[nodiscard]] Matrix read(const char* type, const nlohmann::json& reported) const {
    using Scalar = typename Matrix::Scalar;
    if (reported.at("type").get<std::string>() != type) throw InvalidInput("an array has another type");
    const auto at = reported.at("at").get<std::size_t>();
    const auto rows = reported.at("shape").at(0).get<std::size_t>(),
               columns = reported.at("shape").at(1).get<std::size_t>();
    const bool fits = at <= bytes_.size() && (columns == 0 || rows <= (bytes_.size() - at) / sizeof(Scalar) / columns);
    if (!fits) throw InvalidInput("it is cut off");
    const int fixed = Matrix::RowsAtCompileTime;
    if (fixed != Eigen::Dynamic && rows != static_cast<std::size_t>(fixed))
      throw InvalidInput("an array has another shape");
    Matrix matrix(rows, columns);
    const char* next = bytes_.data() + at;
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
      for (Eigen::Index j = 0; j < matrix.cols(); ++j, next += sizeof(Scalar))
        std::memcpy(&matrix(i, j), next, sizeof(Scalar));
    if constexpr (std::is_floating_point_v<Scalar>)
      if (!matrix.allFinite()) throw InvalidInput("a number of it is not finite");
    return matrix;
  }

 private:
  std::string_view bytes_;
};

nlohmann::ordered_json numbers(const Eigen::VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

Eigen::VectorXd vector_of(const nlohmann::json& values) {
  const auto numbers = values.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), numbers.size());
}

nlohmann::ordered_json polynomials_json(const maps::Polynomials& polynomials, Arrays& arrays) {
  return {{"degrees", arrays.add("u8", polynomials.terms())},
          {"coefficients", arrays.add("f64", polynomials.coefficients())}};
}

maps::Polynomials polynomials_of(const nlohmann::json& reported, const ArrayReader& arrays) {
  maps::Terms terms = arrays.read<maps::Terms>("u8", reported.at("degrees"));
  maps::RowMatrix coefficients = arrays.read<maps::RowMatrix>("f64", reported.at("coefficients"));
  return {std::move(terms), std::move(coefficients)};
}

nlohmann::ordered_json piece_json(const MapPiece& piece, Arrays& arrays) {
  nlohmann::ordered_json reported{{"taut", piece.taut}, {"inputs", piece.inputs}};
  for (const MapNode& node : piece.tree)
    reported["tree"].push_back(
        node.variable < 0
            ? nlohmann::ordered_json{{"cell", node.cell}}
            : nlohmann::ordered_json{
                  {"variable", node.variable}, {"at", node.at}, {"below", node.first}, {"above", node.second}});
  reported["cells"] = nlohmann::ordered_json::array();
  for (const MapCell& cell : piece.cells) {
    nlohmann::ordered_json& made = reported["cells"].emplace_back(nlohmann::ordered_json{
        {"low", numbers(cell.low)}, {"high", numbers(cell.high)}, {"outputs", polynomials_json(cell.outputs, arrays)}});
    if (cell.modes.count() > 0) made["modes"] = polynomials_json(cell.modes, arrays);
  }
  return reported;
}

MapPiece piece_of(const nlohmann::json& reported, const ArrayReader& arrays) {
  MapPiece piece{reported.at("taut").get<std::vector<bool>>(), reported.at("inputs").get<std::vector<Index>>(), {}, {}};
  for (const nlohmann::json& node : reported.at("tree")) {
    if (node.contains("cell"))
      piece.tree.push_back({-1, 0, -1, -1, node.at("cell").get<Index>()});
    else
      piece.tree.push_back({node.at("variable").get<int>(), node.at("at").get<double>(), node.at("below").get<Index>(),
                            node.at("above").get<Index>(), -1});
  }
  for (const nlohmann::json& cell : reported.at("cells")) {
    MapCell& made = piece.cells.emplace_back();
    made.low = vector_of(cell.at("low"));
    made.high = vector_of(cell.at("high"));
    made.outputs = polynomials_of(cell.at("outputs"), arrays);
    if (cell.contains("modes")) made.modes = polynomials_of(cell.at("modes"), arrays);
  }
  return piece;
}

nlohmann::ordered_json header(const MapData& data, Arrays& arrays) {
  nlohmann::ordered_json reported{{"softkin_map", format},         {"softkin", SOFTKIN_VERSION},
                                  {"robot", data.robot},           {"name", data.name},
                                  {"equilibria", data.equilibria}, {"actuation", numbers(data.actuation)}};
  for (const MapInput& input : data.inputs)
    reported["inputs"].push_back({{"name", input.name},
                                  {"unit", input.unit},
                                  {"actuator", input.actuator},
                                  {"low", input.low},
                                  {"high", input.high}});
  for (std::size_t q = 0; q < data.outputs.size(); ++q) {
    const MapOutput& output = data.outputs[q];
    const Index at = q;
    reported["outputs"].push_back({{"name", output.name},
                                   {"unit", output.unit},
                                   {"accuracy", output.accuracy},
                                   {"largest_error", data.check.largest[at]},
                                   {"mean_error", data.check.mean[at]}});
  }
  reported["checked"] = {{"points", data.check.points}, {"outside", data.check.outside}, {"seed", data.check.seed}};
  reported["cables"] = nlohmann::ordered_json::array();
  for (const MapCable& cable : data.cables)
    reported["cables"].push_back({{"actuator", cable.actuator},
                                  {"input", cable.input},
                                  {"command", cable.command},
                                  {"tension", cable.tension},
                                  {"ratio", cable.ratio}});
  for (const MapPiece& piece : data.pieces) reported["pieces"].push_back(piece_json(piece, arrays));
  if (data.shape)
    reported["shape"] = {{"accuracy_mm", data.shape->accuracy_mm},
                         {"largest_error_mm", data.check.shape_largest_mm},
                         {"mean_error_mm", data.check.shape_mean_mm},
                         {"largest_strain_error", data.check.strain_largest},
                         {"units", numbers(data.shape->units)},
                         {"mean", arrays.add("f32", data.shape->mean.transpose().eval())},
                         {"modes", arrays.add("i16", data.shape->modes.transpose().eval())}};
  return reported;
}

MapData data_of(const nlohmann::json& reported, const ArrayReader& arrays) {
  MapData data;
  data.robot = reported.at("robot").get<std::string>();
  data.name = reported.at("name").get<std::string>();
  data.equilibria = reported.at("equilibria").get<Index>();
  data.actuation = vector_of(reported.at("actuation"));
  for (const nlohmann::json& input : reported.at("inputs"))
    data.inputs.push_back({input.at("name").get<std::string>(), input.at("unit").get<std::string>(),
                           input.at("actuator").get<Index>(), input.at("low").get<double>(),
                           input.at("high").get<double>()});
  const nlohmann::json& outputs = reported.at("outputs");
  data.check.largest.resize(outputs.size());
  data.check.mean.resize(outputs.size());
  for (const nlohmann::json& output : outputs) {
    const Index at = data.outputs.size();
    data.outputs.push_back({output.at("name").get<std::string>(), output.at("unit").get<std::string>(),
                            output.at("accuracy").get<double>()});
    data.check.largest[at] = output.at("largest_error").get<double>();
    data.check.mean[at] = output.at("mean_error").get<double>();
  }
  const nlohmann::json& checked = reported.at("checked");
  data.check.points = checked.at("points").get<Index>();
  data.check.outside = checked.at("outside").get<Index>();
  data.check.seed = checked.at("seed").get<std::uint64_t>();
  for (const nlohmann::json& cable : reported.at("cables"))
    data.cables.push_back({cable.at("actuator").get<Index>(), cable.at("input").get<Index>(),
                           cable.at("command").get<double>(), cable.at("tension").get<Index>(),
                           cable.at("ratio").get<Index>()});
  for (const nlohmann::json& piece : reported.at("pieces")) data.pieces.push_back(piece_of(piece, arrays));
  if (!reported.contains("shape")) return data;
  const nlohmann::json& shape = reported.at("shape");
  MapShape& made = data.shape.emplace();
  made.accuracy_mm = shape.at("accuracy_mm").get<double>();
  data.check.shape_largest_mm = shape.at("largest_error_mm").get<double>();
  data.check.shape_mean_mm = shape.at("mean_error_mm").get<double>();
  data.check.strain_largest = shape.at("largest_strain_error").get<double>();
  made.units = vector_of(shape.at("units"));
  using Row = Eigen::Matrix<float, 1, Eigen::Dynamic>;
  made.mean = arrays.read<Row>("f32", shape.at("mean")).transpose();
  using Modes = Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  made.modes = arrays.read<Modes>("i16", shape.at("modes")).transpose();
  return data;
}

}  // namespace

std::string map_bytes(const MapData& data) {
  Arrays arrays;
  std::string text = header(data, arrays).dump();
  text.resize((text.size() + 1 + alignment - 1) / alignment * alignment - 1, ' ');
  return text + "\n" + arrays.bytes();
}

void write_map(const std::filesystem::path& path, const MapData& data) {
  write_file(path, map_bytes(data));
}

MapData map_from_bytes(std::string_view bytes, const std::string& file_name) {
  const std::size_t end = bytes.find('\n');
  if (!bytes.starts_with("{\"softkin_map\":") || end == std::string_view::npos)
    throw InvalidInput({file_name}, "is no map of softkin; softkin map makes one");
  try {
    const nlohmann::json reported = nlohmann::json::parse(bytes.substr(0, end));
    const int found = reported.at("softkin_map").get<int>();
    if (found > format)
      throw InvalidInput("it is of a newer softkin, in format " + std::to_string(found) + "; this one reads format " +
                         std::to_string(format));
    return data_of(reported, ArrayReader(bytes.substr(end + 1)));
  } catch (const nlohmann::json::exception& error) {
    throw InvalidInput({file_name}, std::string("is a broken map: ") + error.what());
  } catch (const InvalidInput& error) {
    throw InvalidInput({file_name}, std::string("is a broken map: ") + error.what());
  }
}

MapData read_map(const std::filesystem::path& path) {
  return map_from_bytes(read_file(path), path.string());
}

void check_robot(const MapData& data, const Model& model, const std::string& file_name) {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput({file_name}, "is not of this robot: " + why + "; make the map anew");
  };
  const MapData now = maps::outline_of(model);
  if (data.inputs.size() != now.inputs.size()) refuse("other actuators vary");
  for (std::size_t i = 0; i < now.inputs.size(); ++i) {
    const MapInput &was = data.inputs[i], &is = now.inputs[i];
    if (was.name != is.name || was.unit != is.unit)
      refuse("it takes '" + was.name + "' where this has '" + is.name + "'");
    if (was.low != is.low || was.high != is.high)
      refuse("the range of '" + is.name + "' was " + number(was.low) + " to " + number(was.high) + ", and is " +
             number(is.low) + " to " + number(is.high));
  }
  if (data.robot != now.robot || data.outputs.size() != now.outputs.size())
    refuse("its mesh, materials, supports, actuators or markers have changed");
}

std::string map_text(const MapData& data) {
  const MapCheck& check = data.check;
  std::string text = counted(static_cast<std::size_t>(data.equilibria), "equilibrium", "equilibria") + "; ";
  if (check.points == 0)
    return text + "not checked, so its errors are unknown: none of " + std::to_string(check.outside) +
           " random actuations is inside the map and has an equilibrium";
  text += "checked at " + counted(static_cast<std::size_t>(check.points), "point") + ", largest errors:";
  const auto add = [&](const std::string& unit, const char* of, double shape) {
    double largest = shape;
    for (std::size_t q = 0; q < data.outputs.size(); ++q)
      if (data.outputs[q].unit == unit) largest = std::max(largest, check.largest[q]);
    text +=
        std::string(text.back() == ':' ? " " : ", ") + of + " " + number(largest, 2) + (unit.empty() ? "" : " " + unit);
  };
  const auto any = [&](const std::string& unit) {
    return std::any_of(data.outputs.begin(), data.outputs.end(), [&](const MapOutput& o) { return o.unit == unit; });
  };
  if (any("mm")) add("mm", "markers", 0);
  if (any("kPa")) add("kPa", "pressures", 0);
  if (any("N")) add("N", "tensions", 0);
  if (any("")) add("", "ratios", 0);
  if (data.shape) {
    add("mm of any vertex", "shape", check.shape_largest_mm);
    text += ", its largest strains " + number(check.strain_largest, 2) + " [-]";
  }
  if (check.outside > 0)
    text += "\n" + std::to_string(check.outside) + " of " + std::to_string(check.points + check.outside) +
            " random actuations are outside the map or have no equilibrium";
  return text;
}

std::string map_json(const MapData& data, const std::string& file_name, double seconds) {
  Arrays arrays;
  nlohmann::ordered_json reported = header(data, arrays), made{{"map", file_name}};
  for (const char* key : {"softkin", "robot", "name", "equilibria", "inputs", "outputs", "checked"})
    made[key] = reported[key];
  made["pieces"] = nlohmann::ordered_json::array();
  for (const MapPiece& piece : data.pieces) {
    Index terms = 0;
    for (const MapCell& cell : piece.cells) terms += cell.outputs.terms().rows();
    made["pieces"].push_back({{"taut", piece.taut}, {"cells", piece.cells.size()}, {"terms", terms}});
  }
  if (data.shape) {
    made["shape"] = reported["shape"];
    for (const char* key : {"mean", "modes", "units"}) made["shape"].erase(key);
    made["shape"]["modes"] = data.shape->units.size();
  }
  made["seconds"] = seconds;
  return made.dump(2);
}

}  // namespace softkin::runs
