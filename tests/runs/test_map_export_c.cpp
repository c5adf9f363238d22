#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/kinematics/map_estimate.hpp>
#include <softkin/runs/map_export.hpp>
#include <softkin/runs/map_export_parts.hpp>

#include "cli/run_program.hpp"
#include "exported_maps.hpp"
#include "support/skips.hpp"

/// The exported header, compiled by the compilers that are there and run, against the map itself.

namespace softkin::runs {
namespace {

using softkin::testing::run_shell;
using softkin::testing::shell_quoted;
using softkin::testing::TemporaryFolder;
using testing::commands_of;
using testing::Exported;

constexpr const char* c_warnings = " -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion -Werror ";

/// All exported headers and a program that runs them one after the other, of its files COMMANDS ANSWERS, a pair each.
std::string program(const std::vector<Exported>& maps, const TemporaryFolder& folder) {
  std::string text = "#include <stdio.h>\nstatic void put(double x, FILE *out) { fwrite(&x, sizeof x, 1, out); }\n";
  std::string main = "int main(int count, char **files) {\n  (void)count;\n";
  const std::string of_one = read_file(SOFTKIN_SOURCE_DIR "/tests/runs/exported_map.c");
  for (std::size_t m = 0; m < maps.size(); ++m) {
    const std::string name = c_name(maps[m].data);
    folder.write(name + ".h", maps[m].header);
    std::string upper = name;
    std::transform(name.begin(), name.end(), upper.begin(), [](char c) { return static_cast<char>(std::toupper(c)); });
    text += "#include \"" + name + ".h\"\n" + replaced(of_one, {{"map_", name + "_"}, {"MAP_", upper + "_"}});
    const std::string files = "files[" + std::to_string(2 * m + 1) + "]",
                      answers = "files[" + std::to_string(2 * m + 2) + "]";
    main += "  {\n    FILE *in = fopen(" + files + ", \"rb\"), *out = fopen(" + answers +
            ", \"wb\");\n    if (!in || !out) return 1;\n    " + name +
            "_run(in, out);\n    fclose(in);\n    fclose(out);\n  }\n";
  }
  return text + main + "  return 0;\n}\n";
}

class ProgramOutput {
 public:
  explicit ProgramOutput(std::string bytes) : bytes_(std::move(bytes)) {}
  double next() {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (at_ + sizeof value <= bytes_.size()) std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  Eigen::VectorXd next(Index count) {
    Eigen::VectorXd values(count);
    for (double& value : values) value = next();
    return values;
  }
  [[nodiscard]] bool all_read() const { return at_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

struct Found {
  int code = -1;
  double error = -1;
  Eigen::VectorXd commands;
};

Found next_found(ProgramOutput& answers, Index inputs) {
  Found found;
  found.code = static_cast<int>(answers.next());
  found.error = answers.next();
  found.commands = answers.next(inputs);
  return found;
}

/// Checks the result of ik: its commands yield its outputs, and their distance from the target is the reported error.
void expect_true(const Exported& map, Found found, const Eigen::Vector3d& target) {
  Eigen::VectorXd values(map.map.outputs());
  for (Index i = 0; i < map.map.inputs(); ++i) {  // bounds in float may be just outside
    const MapInput& input = map.data.inputs[i];
    if (map.floats) found.commands[i] = std::clamp(found.commands[i], input.low, input.high);
  }
  ASSERT_TRUE(map.map.evaluate(found.commands.data(), values.data())) << map.data.name;
  const double rounding = map.floats ? 1e-3 : 1e-9, error = (values.head<3>() - target).norm();
  EXPECT_NEAR(found.error, error, rounding);
  ASSERT_TRUE(found.code == 0 || found.code == 1) << found.code;
  EXPECT_EQ(found.code == 0, found.error <= 1e-3);
}

/// At least one start of a coarse search leads no nearer.
double nearest_of_grid(const KinematicMap& map, const Eigen::Vector3d& target) {
  const Index inputs = map.inputs();
  const int steps = inputs > 3 ? 5 : inputs > 2 ? 13 : 40;
  double nearest = HUGE_VAL;
  Eigen::VectorXd commands(inputs), values(map.outputs());
  for (int n = 0, count = static_cast<int>(std::pow(steps + 1, inputs) + 0.5); n < count; ++n) {
    for (int i = 0, rest = n; i < inputs; ++i, rest /= steps + 1) {
      const MapInput& input = map.data().inputs[i];
      commands[i] = std::min(input.high, input.low + (input.high - input.low) * (rest % (steps + 1)) / steps);
    }
    if (map.evaluate(commands.data(), values.data())) nearest = std::min(nearest, (values.head<3>() - target).norm());
  }
  return nearest;
}

/// Returns if the map's boxes or pieces do not fit together, so that a path to the target may end between them.
bool jumps(const Exported& map) {
  const std::string& name = map.data.name;
  return name.starts_with("2 boxes") || name.starts_with("askew") || name.starts_with("ends");
}

struct Tally {
  int inside = 0, outside = 0, reached = 0, not_reached = 0, amid = 0, estimated = 0;
  double worst_mm = 0, worst = 0, worst_slope = 0;  // over the outputs' scales
};

void compare_values(const Exported& map, const Eigen::VectorXd& values, const maps::RowMatrix& slopes,
                    ProgramOutput& answers, Tally& tally) {
  const Index inputs = map.map.inputs(), outputs = map.map.outputs();
  const Eigen::VectorXd found = answers.next(outputs), alone = answers.next(outputs);
  EXPECT_EQ(found, alone);
  for (Index q = 0; q < outputs; ++q) {
    const double off = std::abs(found[q] - values[q]);
    tally.worst = std::max(tally.worst, off / std::max(1.0, std::abs(values[q])));
    if (map.data.outputs[q].unit == "mm") tally.worst_mm = std::max(tally.worst_mm, off);
  }
  for (Index q = 0; q < outputs; ++q) {
    const Eigen::VectorXd row = answers.next(inputs);
    const double scale = std::max(1.0, slopes.col(q).cwiseAbs().maxCoeff());
    tally.worst_slope = std::max(tally.worst_slope, (row - slopes.col(q)).cwiseAbs().maxCoeff() / scale);
  }
}

void compare_ik(const Exported& map, const Eigen::VectorXd& commands, const Eigen::Vector3d& target, bool grid,
                ProgramOutput& answers, Tally& tally) {
  const Index inputs = map.map.inputs();
  const Found near = next_found(answers, inputs), far = next_found(answers, inputs),
              beside = next_found(answers, inputs);
  if (near.code == 2) {  // where it starts
    EXPECT_TRUE(jumps(map));
  } else {
    expect_true(map, near, target);
    expect_true(map, far, 4 * target);
    ++(near.code == 0 ? tally.reached : tally.not_reached);
    if (grid && !jumps(map)) {
      EXPECT_LE(far.error, nearest_of_grid(map.map, 4 * target) + 1e-3) << map.data.name;
    }
  }
  expect_true(map, beside, target + Eigen::Vector3d(0.1, 0, 0));
  bool amid = inputs > 3;  // more than coordinates, and far from all bounds
  for (Index i = 0; i < inputs; ++i) {
    const MapInput& input = map.data.inputs[i];
    amid = amid && std::abs((2 * commands[i] - input.low - input.high) / (input.high - input.low)) < 0.7;
  }
  if (!amid) return;
  ++tally.amid;
  EXPECT_EQ(beside.code, 0);
  EXPECT_LE((beside.commands - commands).cwiseAbs().maxCoeff(), 0.03);
}

/// As estimate_by_map() has it, of all commands but the first, from outputs that are a little off.
void compare_estimate(const Exported& map, const Eigen::VectorXd& commands, const Eigen::VectorXd& values,
                      ProgramOutput& answers, Tally& tally) {
  const Index inputs = map.map.inputs(), outputs = map.map.outputs();
  const int code = static_cast<int>(answers.next());
  const double chi_square = answers.next();
  const Eigen::VectorXd reported = answers.next(inputs), covariance = answers.next(inputs * inputs);
  Eigen::VectorXd begin = commands, readings = values;
  std::vector<MapUnknown> unknowns;
  for (Index i = 1; i < inputs; ++i) {
    const MapInput& input = map.data.inputs[i];
    unknowns.push_back({i, (input.low + input.high) / 2, (input.high - input.low) / 2});
    begin[i] = unknowns.back().mean;
  }
  for (Index q = 0; q < outputs; ++q) readings[q] = q % 4 == 3 ? std::nan("") : values[q] + 0.01 * double(q % 3 - 1);
  const auto own = estimate_by_map(map.map, unknowns, begin, readings, Eigen::VectorXd::Constant(outputs, 0.1));
  EXPECT_EQ(code == 2, !own);
  if (!own || jumps(map)) return;
  EXPECT_EQ(code, own->converged ? 0 : 1);
  if (code != 0 || !own->converged) return;
  ++tally.estimated;
  for (std::size_t u = 0; u < unknowns.size(); ++u) {
    const Index i = unknowns[u].input;
    const double deviation = std::sqrt(own->covariance(u, u));
    EXPECT_NEAR(reported[i], own->commands[i], (map.floats ? 0.05 : 0.003) * deviation) << map.data.name;
    // in float, normal equations round poorly determined directions
    EXPECT_NEAR(std::sqrt(covariance[i * inputs + i]), deviation, (map.floats ? 0.5 : 0.003) * deviation);
  }
  EXPECT_NEAR(chi_square, own->chi_square, map.floats ? 0.05 : 0.003);
}

/// Of a map whose table is damaged: its check() notices.
void expect_noticed(const std::string& answers) {
  ASSERT_GE(answers.size(), 2 * sizeof(double));
  EXPECT_GT(ProgramOutput(answers.substr(answers.size() - 2 * sizeof(double))).next(), 0);
}

Tally compare(const Exported& map, ProgramOutput answers) {
  Tally tally;
  const Index inputs = map.map.inputs(), outputs = map.map.outputs();
  Eigen::VectorXd values(outputs);
  maps::RowMatrix slopes(inputs, outputs);
  for (const Eigen::VectorXd& commands : map.commands) {
    const bool inside = map.map.evaluate(commands.data(), values.data(), slopes.data()).has_value();
    EXPECT_EQ(answers.next(), inside ? 0 : 2);
    EXPECT_EQ(answers.next(), inside ? 0 : 2);
    if (!inside) {
      ++tally.outside;
      continue;
    }
    compare_values(map, values, slopes, answers, tally);
    compare_ik(map, commands, values.head<3>(), ++tally.inside <= 10, answers, tally);
    compare_estimate(map, commands, values, answers, tally);
  }
  EXPECT_EQ(answers.next(), 0) << "check()";
  EXPECT_NE(map.header.find("Tables: " + std::to_string(static_cast<int>(answers.next())) + " bytes"),
            std::string::npos);
  EXPECT_TRUE(answers.all_read());
  return tally;
}

/// Every map in double and in float; and one with a coefficient that is another, as by a transfer that went wrong.
std::vector<Exported> exported_headers() {
  std::vector<Exported> maps;
  for (const CNumbers numbers : {CNumbers::doubles, CNumbers::floats})
    for (MapData data : testing::small_maps()) {
      data.name += numbers == CNumbers::floats ? " in float" : "";
      Exported& map = maps.emplace_back(data, numbers == CNumbers::floats);
      map.header = map_c_header(data, numbers);
      map.commands = commands_of(map.map, map.floats);
    }
  MapData data = testing::arm_map();
  data.name = "tampered";
  Exported& map = maps.emplace_back(data, false);
  map.header = map_c_header(data, CNumbers::doubles);
  const std::size_t table = map.header.find("tampered_coefficients["), row = map.header.find("\n ", table);
  map.header.insert(map.header.find('.', row) + 1, "5");
  map.tampered = true;
  map.commands = commands_of(map.map, false);
  return maps;
}

void write_doubles(const TemporaryFolder& folder, const std::string& name, const std::vector<Eigen::VectorXd>& rows) {
  std::string bytes;
  for (const Eigen::VectorXd& row : rows)
    bytes.append(reinterpret_cast<const char*>(row.data()), static_cast<std::size_t>(row.size()) * sizeof(double));
  folder.write(name, bytes);
}

TEST(MapExportC, AnswersAsTheMapDoes) {
  SKIP_WITHOUT_PROGRAM("cc");
  const TemporaryFolder folder;
  const std::vector<Exported> maps = exported_headers();
  const std::string source = folder.write("maps.c", program(maps, folder)), run = folder / "maps";
  const auto built =
      run_shell("cc -std=c99 -O1 -fsanitize=address,undefined -fno-sanitize-recover=all" + std::string(c_warnings) +
                "-o " + shell_quoted(run) + " " + shell_quoted(source) + " 2>&1");
  ASSERT_EQ(built.exit_code, 0) << built.output;
  std::string command = shell_quoted(run);
  for (std::size_t m = 0; m < maps.size(); ++m) {
    write_doubles(folder, "commands" + std::to_string(m), maps[m].commands);
    command += " " + shell_quoted(folder / ("commands" + std::to_string(m))) + " " +
               shell_quoted(folder / ("answers" + std::to_string(m)));
  }
  const auto ran = run_shell(command + " 2>&1");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  for (std::size_t m = 0; m < maps.size(); ++m) {
    SCOPED_TRACE(maps[m].data.name);
    const std::string answers = read_file(folder / ("answers" + std::to_string(m)));
    if (maps[m].tampered) {
      expect_noticed(answers);
      continue;
    }
    const Tally tally = compare(maps[m], ProgramOutput(answers));
    EXPECT_GT(tally.inside, 100);
    EXPECT_GT(tally.outside, 2);
    if (maps[m].map.inputs() > 3) {
      EXPECT_GT(tally.amid, 10);
    }
    EXPECT_LE(tally.worst, maps[m].floats ? 1e-5 : 1e-12);
    EXPECT_LE(tally.worst_mm, maps[m].floats ? 1e-3 : 1e-11);
    EXPECT_LE(tally.worst_slope, maps[m].floats ? 1e-3 : 1e-10);
    if (!jumps(maps[m])) {
      EXPECT_LE(tally.not_reached, tally.reached / 50);
      EXPECT_GT(tally.estimated, tally.inside / 2);
    }
  }
}

class MapExportCompilers : public ::testing::TestWithParam<const char*> {};

TEST_P(MapExportCompilers, CompileItWithoutAnyInclude) {
  const std::string with = GetParam(), compiler = with.substr(0, with.find(' '));
  SKIP_WITHOUT_PROGRAM(compiler);
  const TemporaryFolder folder;
  const std::vector<Exported> maps = exported_headers();
  std::string source;
  for (const Exported& map : maps) source += "#include \"" + c_name(map.data) + ".h\"\n";
  source += source;  // guarded
  for (const Exported& map : maps) folder.write(c_name(map.data) + ".h", map.header);
  const std::string file = folder.write(compiler.ends_with("++") ? "all.cpp" : "all.c", source);
  const auto built =
      run_shell(with + c_warnings + "-ffreestanding -nostdinc -c -o /dev/null " + shell_quoted(file) + " 2>&1");
  EXPECT_EQ(built.exit_code, 0) << with << "\n" << built.output;
}

INSTANTIATE_TEST_SUITE_P(MapExportC, MapExportCompilers,
                         ::testing::Values("gcc -std=c99 -O2", "clang -std=c99", "clang -std=c11", "g++ -std=c++11 -O2",
                                           "clang++ -std=c++20"));

TEST(MapExportC, TellsWhatItIs) {
  const MapData data = testing::cable_map();
  const std::string header = map_c_header(data, CNumbers::floats);
  softkin::testing::expect_words(
      header, {"checked at 200 points", "not a bound", "tip_x within 1e-05 mm", "typedef float finger_map_1_real;",
               "#define FINGER_MAP_1_INPUTS 3\n", "FINGER_MAP_1_IN_TENDON2 = 2 /* tendon2: a ratio, 0.5 to 1.2 */",
               "FINGER_MAP_1_OUT_TENDON1_TENSION = 3 /* tendon1_tension: N */", "FINGER_MAP_1_MARKER_TIP = 0",
               "bytes of flash", "Stack: about", "'finger \"map_1\" * / "});
  EXPECT_EQ(header.find("double"), std::string::npos);
  EXPECT_EQ(header.find("#include"), std::string::npos);
}

TEST(MapExportC, NamesAreIdentifiers) {
  const auto name = [](const std::string& text) {
    MapData data;
    data.name = text;
    return c_name(data);
  };
  EXPECT_EQ(name("Three-chamber arm"), "three_chamber_arm");
  EXPECT_EQ(name("5 chambers"), "robot_5_chambers");
  EXPECT_EQ(name(""), "robot");
  EXPECT_EQ(name("\xc3\xbc*/ "), "robot");
  EXPECT_EQ(name("__a__b__"), "a_b");
}

TEST(MapExportC, AMapWithoutAnswersIsRefused) {
  MapData data = testing::arm_map(20);
  data.pieces[0].tree[0].cell = -1;
  EXPECT_THROW((void)map_c_header(data, CNumbers::doubles), InvalidInput);
  EXPECT_THROW((void)map_js_module(data), InvalidInput);
}

}  // namespace
}  // namespace softkin::runs
