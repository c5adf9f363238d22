#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/base64.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/runs/answers.hpp>
#include <softkin/runs/page.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/runs/shape_files.hpp>

#include "small_maps.hpp"
#include "small_runs.hpp"

namespace softkin::runs {
namespace {

using namespace testing;
using PageJson = nlohmann::json;

template <class Number>
std::vector<Number> unpacked(const std::string& text) {
  const std::string bytes = from_base64(text);
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

std::vector<float> floats_of(const PageJson& array) {
  if (array.contains("u16")) {  // rounded
    const auto low = array.at("low").get<std::vector<double>>(), step = array.at("step").get<std::vector<double>>();
    std::vector<float> numbers;
    for (const std::uint16_t level : unpacked<std::uint16_t>(array.at("u16").get<std::string>())) {
      const std::size_t c = numbers.size() % low.size();
      numbers.push_back(static_cast<float>(low[c] + step[c] * level));
    }
    return numbers;
  }
  return unpacked<float>(array.at("f32").get<std::string>());
}

std::vector<std::uint32_t> corners_of(const PageJson& array) {
  return unpacked<std::uint32_t>(array.at("u32").get<std::string>());
}

Points points_of(const PageJson& array) {
  const std::vector<float> numbers = floats_of(array);
  Points points(static_cast<Index>(numbers.size() / 3), 3);
  for (std::size_t i = 0; i < 3 * static_cast<std::size_t>(points.rows()); ++i)
    points.data()[i] = static_cast<double>(numbers[i]);
  return points;
}

std::vector<Triangle> triangles_of(const PageJson& array) {
  std::vector<Triangle> triangles;
  const std::vector<std::uint32_t> corners = corners_of(array);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    triangles.push_back(
        {static_cast<Index>(corners[i]), static_cast<Index>(corners[i + 1]), static_cast<Index>(corners[i + 2])});
  return triangles;
}

/// A block of two materials and a hole, with a cable through its inside.
Model page_model(int order, const std::string& more = "") {
  return block_model(
      "softkin: 1\nmesh: {file: block.msh, order: " + std::to_string(order) +
      "}\nmaterials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\nvoid: [chamber]\nfixed: [{region: base}]\n"
      "actuators: [{name: tendon, kind: cable, points: [[0, 6, 2.5], [4, 6, 2.5], [12, 6, 2.5]], "
      "control: tension, range: [0, 5]}]\n"
      "markers: [{name: tip, region: tip}]\n" +
      more);
}

StepRecord rest_record(const Model& model) {
  Equilibrium found;
  found.state = Statics(model).rest();
  found.actuation = found.state.actuation = model.rest_actuation();
  found.report.status = Status::converged;
  found.state.multipliers = Eigen::VectorXd::Constant(model.rest_actuation().size(), 2.5);
  return step_record(model, found, deformation_of(model, model.rest));
}

/// A shape that is no equilibrium, and quadratic in x: what an element averages is not what its vertices have.
Points bent(const Model& model) {
  Points positions = model.rest;
  positions.col(0).array() += 0.01 * model.rest.col(0).array().square();
  positions.col(2).array() -= 0.02 * model.rest.col(0).array().square();
  return positions;
}

PageJson page_of(const Model& model, const PageDocument& document, const MapData* map = nullptr) {
  PageJson page = PageJson::parse(document.text(map));
  EXPECT_EQ(page.at("robot"), model.name);
  return page;
}

TEST(Page, SurfaceIsClosedAndOutward) {
  for (const int order : {1, 2}) {
    const Model model = page_model(order);
    PageDocument document(model, "softkin fk");
    document.add(rest_record(model), bent(model), deformation_of(model, bent(model)));
    const PageJson page = page_of(model, document), &surface = page.at("surface");
    const std::vector<Triangle> triangles = triangles_of(surface.at("triangles"));
    std::map<std::pair<Index, Index>, int> edges;
    for (const Triangle& t : triangles)
      for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
    for (const auto& [edge, times] : edges) {
      EXPECT_EQ(times, 1);
      EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
    }
    const Points rest = points_of(surface.at("rest"));
    EXPECT_NEAR(enclosed_volume(rest, triangles), (27 - 1) * 64, 1e-3) << order;
    // a vertex of the surface comes before those that only the cable needs
    std::vector<bool> of_surface(rest.rows());
    for (const Triangle& t : triangles)
      for (const Index v : t) of_surface[v] = true;
    EXPECT_TRUE(std::is_partitioned(of_surface.begin(), of_surface.end(), [](bool is) { return is; }));
    EXPECT_EQ(triangles.size(), order == 1 ? 120u : 480u);  // 6 x 9 + 6 squares
    const auto regions = unpacked<std::uint16_t>(surface.at("region").at("u16").get<std::string>());
    ASSERT_EQ(regions.size(), triangles.size());
    for (const std::uint16_t region : regions) EXPECT_EQ(page.at("regions").at(region), "body");
  }
}

TEST(Page, StepsHaveTheShapeOfTheVtu) {
  for (const int order : {1, 2}) {
    const Model model = page_model(order);
    const Points positions = bent(model);
    StepRecord record = rest_record(model);
    record.status = Status::not_converged;
    record.remark = "it </script> swings";
    record.time_s = 0.5;
    PageDocument document(model, "softkin fk");
    document.add(rest_record(model), model.rest, deformation_of(model, model.rest));
    document.add(record, positions, deformation_of(model, positions));
    const PageJson page = page_of(model, document);
    ASSERT_EQ(page.at("steps").size(), 2u);
    const PageJson& step = page.at("steps").at(1);
    const TemporaryFolder folder;
    write_shape(folder / "a.vtu", model, {positions}, deformation_of(model, positions), true);
    const Points written = read_vtu_points(folder / "a.vtu"), shown = points_of(step.at("positions"));
    ASSERT_EQ(static_cast<std::size_t>(shown.rows()), document.vertices().size());
    const double rounding = std::sqrt(3) * 14 / 65535 / 2;  // the block reaches 13.44 mm along x, less across it
    for (Index i = 0; i < shown.rows(); ++i)
      EXPECT_LT((shown.row(i) - written.row(document.vertices()[i])).norm(), rounding + 1e-5);
    EXPECT_EQ(step.at("status"), "not converged");
    EXPECT_EQ(step.at("remark"), record.remark);
    EXPECT_EQ(step.at("loads"), PageJson::parse("[2.5]"));
    EXPECT_EQ(step.at("commands"), PageJson::parse("[0.0]"));
    EXPECT_EQ(step.at("time_s"), 0.5);
    EXPECT_TRUE(page.at("steps").at(0).at("time_s").is_null());
    EXPECT_NEAR(step.at("markers").at(0).at(0).get<double>(), 12, 1e-9);  // of the record
    EXPECT_EQ(page.at("actuators").at(0).at("unit"), "N");
    EXPECT_EQ(page.at("actuators").at(0).at("load_unit"), "N");
    EXPECT_EQ(page.at("markers").at(0).at("name"), "tip");
    EXPECT_TRUE(page.at("map").is_null());
  }
}

TEST(Page, CablesAreWhereTheyAreInTheModel) {
  const Model model = page_model(2);
  const Points positions = bent(model);
  PageDocument document(model, "softkin fk");
  document.add(rest_record(model), positions, deformation_of(model, positions));
  const PageJson page = page_of(model, document);
  const Points shown = points_of(page.at("steps").at(0).at("positions"));
  const PageJson& points = page.at("cables").at(0).at("points");
  ASSERT_EQ(points.size(), model.actuators[0].as<CableDrive>()->points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vec3 at = Vec3::Zero();
    for (std::size_t k = 0; k < points[i].at("vertices").size(); ++k)
      at += points[i].at("weights").at(k).get<double>() *
            shown.row(points[i].at("vertices").at(k).get<Index>()).transpose();
    EXPECT_LT((at - model.actuators[0].as<CableDrive>()->points[i].at(positions)).norm(), 2e-4);
  }
}

TEST(Page, UniformFieldsTellTheirDirections) {
  const Model model = block_model(
      "softkin: 1\nmesh: {file: block.msh}\n"
      "materials: [{region: all, youngs_modulus: 1, poisson_ratio: 0.3, remanence: [100, 0, 0]}]\n"
      "fixed: [{region: base}]\nactuators:\n"
      "  - {name: slanted, kind: magnetic, direction: [3, 0, 4], range: [-2, 2]}\n"
      "  - {name: field, kind: magnetic, axes: [x, z], range: [-1, 1]}\n"
      "  - {name: coil, kind: magnetic, coils: [{center: [0, 0, -30], axis: [0, 0, 1], radius: 9}], range: [-1, 1]}\n"
      "  - {name: magnet, kind: magnetic, dipole: {position: [0, 0, -40], moment: [0, 0, [-1, 1]]}}\n"
      "  - {name: tendon, kind: cable, points: [[0, 6, 12], [12, 6, 12]], control: tension, range: [0, 5]}\n");
  const PageJson page = page_of(model, PageDocument(model, ""));
  std::map<std::string, PageJson> reported;
  for (const PageJson& actuator : page.at("actuators")) reported[actuator.at("name")] = actuator;
  EXPECT_EQ(reported.at("slanted").at("flux_density"), PageJson::parse("[0.6, 0.0, 0.8]"));
  EXPECT_EQ(reported.at("slanted").at("kind"), "magnetic");
  EXPECT_EQ(reported.at("slanted").at("unit"), "mT");
  EXPECT_EQ(reported.at("field_x").at("flux_density"), PageJson::parse("[1.0, 0.0, 0.0]"));
  EXPECT_EQ(reported.at("field_z").at("flux_density"), PageJson::parse("[0.0, 0.0, 1.0]"));
  for (const char* other : {"coil", "magnet_mz", "tendon"}) EXPECT_FALSE(reported.at(other).contains("flux_density"));
}

/// By a search over all elements for each vertex.
TEST(Page, FieldsAreMeansOfTheElementsAround) {
  const Model model = page_model(2);
  const Points positions = bent(model);
  const ElementDeformation deformation = deformation_of(model, positions);
  PageDocument document(model, "softkin fk");
  document.add(rest_record(model), positions, deformation);
  const PageJson page = page_of(model, document), &fields = page.at("steps").at(0).at("fields");
  const std::vector<float> strain = floats_of(fields.at("strain")), ratio = floats_of(fields.at("volume_ratio"));
  ASSERT_EQ(strain.size(), document.vertices().size());
  for (std::size_t i = 0; i < strain.size(); ++i) {
    const Index v = document.vertices()[i];
    double sum = 0, ratios = 0;
    int count = 0;  // all elements have the same volume
    for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
      const auto& corners = model.elements.tetrahedra[e];
      const auto& nodes = model.elements.edge_nodes[e];
      if (std::count(corners.begin(), corners.end(), v) + std::count(nodes.begin(), nodes.end(), v) == 0) continue;
      sum += deformation.strain[e][0];
      ratios += deformation.volume_ratio[e];
      ++count;
    }
    ASSERT_GT(count, 0);
    EXPECT_NEAR(strain[i], sum / count, 5e-6);  // rounded
    EXPECT_NEAR(ratio[i], ratios / count, 5e-6);
  }
  EXPECT_FALSE(fields.contains("contact_pressure"));
}

TEST(Page, ShowsWhatIsAround) {
  const Model model = page_model(1, "obstacles: [{name: kerb, box: [[14, 0, 0], [15, 10, 10]]}]\n");
  PageDocument document(model, "softkin fk");
  document.add(rest_record(model), model.rest, deformation_of(model, model.rest));
  const PageJson page = page_of(model, document), &kerb = page.at("obstacles").at(0);
  EXPECT_NEAR(enclosed_volume(points_of(kerb.at("points")), triangles_of(kerb.at("triangles"))), 100, 1e-3);
  EXPECT_FALSE(page.contains("bodies"));

  const Model grasped = page_model(1, "bodies: [{name: a, box: [[14, 0, 0], [24, 10, 10]]}]\n");
  PageDocument with_body(grasped, "softkin fk");
  Points moved = grasped.rest;
  for (const Index v : grasped.bodies[0].vertices) moved(v, 2) += 3;
  with_body.add(rest_record(grasped), moved, deformation_of(grasped, moved));
  const PageJson shown = page_of(grasped, with_body);
  const Points at = points_of(shown.at("steps").at(0).at("positions"));
  const std::vector<Triangle> triangles = triangles_of(shown.at("bodies").at("triangles"));
  EXPECT_NEAR(enclosed_volume(at, triangles), 1000, 1e-2);
  for (const Triangle& t : triangles) EXPECT_GT(at(t[0], 2), 2.9);
}

/// A made-up map with a shape of the model's vertices.
MapData map_of_vertices(const Model& model) {
  MapData map = cable_map();
  MapShape& shape = *map.shape;
  std::mt19937 generator(9);
  shape.mean = model.rest.cast<float>().reshaped<Eigen::RowMajor>();
  shape.modes.resize(shape.mean.size(), shape.units.size());
  for (Index k = 0; k < std::ssize(shape.modes); ++k)
    shape.modes.data()[k] = static_cast<std::int16_t>(static_cast<int>(generator() % 60000) - 30000);
  return map;
}

TEST(Page, MapBendsTheVerticesOfThePage) {
  const Model model = page_model(1);
  const MapData data = map_of_vertices(model);
  const KinematicMap map(data);
  PageDocument document(model, "softkin fk");
  const PageJson reported = page_of(model, document, &data).at("map");
  EXPECT_EQ(reported.at("inputs").size(), 3u);
  EXPECT_EQ(reported.at("markers"), PageJson::parse("[\"tip\"]"));
  const PageJson& shape = reported.at("shapeTables");
  const auto mean = unpacked<float>(shape.at("mean").get<std::string>());
  const auto modes = unpacked<std::int16_t>(shape.at("modes").get<std::string>());
  const auto units = shape.at("units").get<std::vector<double>>();
  const std::size_t numbers = 3 * document.vertices().size();
  ASSERT_EQ(mean.size(), numbers);
  ASSERT_EQ(modes.size(), units.size() * numbers);
  for (const double air : {0.2, 1.0, 1.9}) {
    const Eigen::Vector3d commands(air, 1, 0.9);
    Eigen::VectorXd outputs(map.outputs());
    const auto place = map.evaluate(commands.data(), outputs.data());
    ASSERT_TRUE(place);
    const Points wanted = map.shape(commands.data(), *place);
    // the amplitudes from which small_maps.hpp made the map; bits: the piece's taut cables
    const auto& taut = data.pieces[place->piece].taut;
    const double bits = (taut[0] ? 1 : 0) + (taut[1] ? 2 : 0);
    Eigen::Vector3d amounts = commands;
    if (!taut[0]) amounts[1] = 1;
    if (!taut[1]) amounts[2] = 0.9;
    const Eigen::Vector3d amplitudes(amounts.sum() - 1, air * amounts[1], air * air - bits);
    for (std::size_t i = 0; i < document.vertices().size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        double at = static_cast<double>(mean[3 * i + k]);
        for (std::size_t m = 0; m < units.size(); ++m) at += units[m] * amplitudes[m] * modes[m * numbers + 3 * i + k];
        EXPECT_NEAR(at, wanted(document.vertices()[i], k), 1e-4);
      }
  }
  const MapData other = cable_map();
  EXPECT_THROW((void)document.text(&other), InvalidInput);
}

TEST(Page, NoTextOfADocumentEndsIt) {
  const std::string begin = "<html><script type=\"application/json\" id=\"softkin-page\">", end = "</script></html>";
  const Model model = page_model(1);
  const std::string command = "a </script><!-- <script> \xff & 'b'";
  const std::string text = PageDocument(model, command).text(nullptr);
  const std::string html = page_html(begin + "null" + end, text);
  ASSERT_EQ(html.substr(0, begin.size()), begin);
  ASSERT_EQ(html.substr(html.size() - end.size()), end);
  const std::string inside = html.substr(begin.size(), html.size() - begin.size() - end.size());
  EXPECT_EQ(inside.find('<'), std::string::npos);
  EXPECT_EQ(PageJson::parse(inside), PageJson::parse(text));
  EXPECT_NE(PageJson::parse(inside).at("command").get<std::string>().find("</script><!-- <script>"), std::string::npos);
  for (const std::string& page : {std::string("<html></html>"), begin, begin + end + begin + end})
    EXPECT_THROW((void)page_html(page, "{}"), InvalidInput) << page;
}

TEST(Page, CommandsAreWhatAShellTakes) {
  EXPECT_EQ(command_line({"softkin", "fk", "a b.yaml", "--set", "air=1.5", "it's", ""}),
            "softkin fk 'a b.yaml' --set air=1.5 'it'\\''s' ''");
  const std::vector<std::string> words{"$(id)", "a\"b", "*", "~", "a\nb", "#", "\\"};
  const auto run = softkin::testing::run_shell("printf '%s|' " + command_line(words));
  std::string wanted;
  for (const std::string& word : words) wanted += word + "|";
  EXPECT_EQ(run.output, wanted);
}

TEST(Page, ShowsWhereAMarkerGets) {
  const Model model = page_model(1);
  PageDocument document(model, "");
  Points reached(2, 3);
  reached << 1, 2, 3, 4, 5, 6.5;
  EXPECT_FALSE(page_of(model, document).contains("workspace"));
  document.show_reach(0, reached);
  const PageJson reach = page_of(model, document).at("workspace");
  EXPECT_EQ(reach.at("marker"), 0);
  EXPECT_EQ(points_of(reach.at("points")), reached);
}

using StepRun = Run<StepRecord>;  // in a test Run is another one

TEST(Page, TakesStepsThatAreMadeAndTakenOver) {
  const Model model = bending_model();
  const Answers answers(model, "", false);
  const std::vector<ActuationStep> steps = steps_of(model, 3);
  const TemporaryFolder folder;
  const RunFiles files{folder / "r.json", folder / "s.pvd"};
  std::vector<StepRecord> seen;
  std::vector<Points> shapes;
  std::vector<bool> made;
  const auto watch = [&](StepRun& run) {
    seen.clear();
    shapes.clear();
    made.clear();
    run.watch([&](const StepRecord& record, const Points& positions, const ElementDeformation* deformation) {
      seen.push_back(record);
      shapes.push_back(positions);
      made.push_back(deformation != nullptr);
    });
  };
  const auto advance = [](StepRun& run, std::size_t until) {
    while (run.done() < until) ASSERT_EQ(run.advance({}), Advance::made);
  };
  const std::string head = report_head(model, "block.yaml", one_thread());
  {
    PathJob job(answers.statics(), steps, "", one_thread());
    StepRun run(model, job, files, head, {});
    watch(run);
    advance(run, 2);
    ASSERT_EQ(seen.size(), 2u);
    run.finish();
  }
  const std::vector<Points> before = shapes;
  PathJob job(answers.statics(), steps, "", one_thread());
  StepRun run(model, job, files, head, {});
  watch(run);
  std::string remark;
  run.resume(remark);
  advance(run, 3);
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(made, (std::vector<bool>{false, false, true}));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(seen[i].actuation, steps[i].actuation);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(largest_move(before[i], shapes[i]), 1e-12);
}

}  // namespace
}  // namespace softkin::runs
