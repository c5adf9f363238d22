#include <cmath>
#include <cstdio>
#include <filesystem>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>

#include <softkin/io/table/settings.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/contacts_json.hpp>
#include <softkin/runs/inverse_text.hpp>
#include <softkin/runs/plots.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/runs/shape_files.hpp>
#include <softkin/runs/shortfall_text.hpp>
#include <softkin/runs/workspace_file.hpp>
#include "command.hpp"
#include "ik_options.hpp"
#include "run_text.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

/// Where the search begins, and what it may change.
struct Search {
  std::vector<runs::NamedGoal> requested;
  std::vector<Goal> goals;
  Actuation start;
  std::optional<State> shape{};  // at the start; none: not known
  InverseOptions inverse;
};

/// The shape in a file.
State shape_of(const Model& model, const std::string& file) {
  State shape = runs::read_state(file, model);
  if (!shape.knows(model.actuators.size()))
    throw InvalidInput({file}, "the shape is of no equilibrium that is known: a search cannot begin there");
  check_actuation(model, shape.actuation);
  return shape;
}

Search requested_search(const Model& model, const IkOptions& options) {
  Search search;
  search.requested = requested_goals(model, options);
  for (const runs::NamedGoal& goal : search.requested) search.goals.push_back(goal.goal);
  const bool from_file = !options.start_file().empty();
  if (from_file) search.shape = shape_of(model, options.start_file());
  const Settings start = from_file ? Settings(model.actuators.size()) : read_settings(model, "--start", options.start);
  const Settings prefer = read_settings(model, "--prefer", options.prefer);
  const Settings fix = read_settings(model, "--fix", options.fix);
  for (std::size_t a = 0; a < fix.size(); ++a)
    if (fix[a] && (start[a] || prefer[a]))
      throw InvalidInput("--fix " + model.actuators[a].name + ": this actuator does not change, so it takes no --" +
                         (start[a] ? "start" : "prefer"));
  search.start = search.shape                ? search.shape->actuation
                 : options.workspace.empty() ? model.rest_actuation()
                                             : runs::nearest_actuation(model, options.workspace, search.goals);
  search.start = with_settings(with_settings(search.start, start), fix);
  search.inverse = options.inverse();
  search.inverse.preferred = with_settings(search.start, prefer);
  for (const auto& value : fix) search.inverse.free.push_back(!value);
  return search;
}

class IkRun {
 public:
  IkRun(const Model& model, const runs::Answers& answers, const IkOptions& options, const Search& search)
      : model_(model), answers_(answers), options_(options), search_(search) {}

  int run() {
    ProgressLine line;
    const double begin = seconds_now();
    const auto show = [&](const Progress& p) {
      std::string text = counted(static_cast<std::size_t>(p.iteration + 1), "equilibrium", "equilibria") + ", " +
                         duration(seconds_now() - begin);
      if (std::isfinite(p.step_mm))
        text += ", " + (any_force(search_.goals) ? number(p.step_mm / p.tolerance_mm, 2) + " times the tolerance off"
                                                 : number(p.step_mm, 2) + " mm off");
      line.show(-1, text);
      return !interrupted();
    };
    found_ = search_.shape ? solve_inverse(answers_.statics(), search_.goals, *search_.shape, search_.inverse, show)
                           : answers_.inverse(search_.goals, search_.start, search_.inverse, show);
    line.clear();
    if (found_.errors_mm.size() == 0) return no_start();
    write();
    if (found_.status == InverseStatus::reached) return done;
    std::fprintf(stderr, "softkin: %s\n", runs::shortfall_text(model_, search_.goals, found_).c_str());
    return not_converged;
  }

 private:
  [[nodiscard]] int no_start() const {
    std::fprintf(stderr, "softkin: %s\n", found_.remark.c_str());
    return not_converged;
  }

  void write() const {
    const Points& positions = found_.equilibrium.state.positions;
    const ElementDeformation deformation = answers_.statics().measured(found_.equilibrium.state);
    const runs::InverseRecord record = runs::inverse_record(model_, search_.goals, found_, deformation);
    const std::string title = fs::path(options_.scene).filename().string() + ": " + name_of(found_.status) + ", " +
                              runs::misses_text(record.misses, 2) + " off";
    if (!options_.output.empty())
      runs::write_shape(options_.output, model_, found_.equilibrium.state, deformation,
                        found_.equilibrium.report.status == Status::converged);
    if (!options_.show.image.empty())
      runs::write_image(options_.show.image, model_, positions, options_.show.view, title, search_.goals);
    if (!options_.show.plot.empty())
      write_svg(options_.show.plot,
                runs::plot_of_search(found_, search_.inverse.tolerance_mm, options_.scene, record.misses));
    if (!options_.json) {
      const std::string found = findings_text(model_, record);
      const runs::InverseTables tables = runs::inverse_tables(model_, search_.requested, found_, record);
      print(table_text(tables.actuators));
      for (const Table* table : {&tables.goals, &tables.forces})
        if (!table->rows.empty()) print(table_text(*table));
      print((found.empty() ? "" : found + "\n") + sliding_text(record) + std::string(name_of(found_.status)) + ": " +
            runs::inverse_summary(found_, record.misses) + "\n");
    }
    const InverseOptions how = options_.inverse();
    runs::RecordLog report = runs::inverse_report(model_, options_.scene, options_.report,
                                                  {how, search_.requested, found_, record}, answers_.map());
    report.finish();
    if (options_.json) report.report(print_piece);
    print(std::string());
    for (const Output& output : options_.outputs())
      if (!options_.json) print(output.option.substr(2) + ": " + output.file.string() + "\n");
  }

  /// What the Jacobian of the report is of, where something slides.
  [[nodiscard]] std::string sliding_text(const runs::InverseRecord& record) const {
    std::string text;
    if (!found_.sensitivity.regular) return text;
    for (const auto& [on, by] : runs::sliding_pairs(model_, record.forces.contacts))
      text += (text.empty() ? "" : ", ") + on + " on " + by;
    return text.empty() ? text : "the Jacobian is one-sided: that for sliding on, of " + text + "\n";
  }

  const Model& model_;
  const runs::Answers& answers_;
  const IkOptions& options_;
  const Search& search_;
  InverseResult found_;
};

int run_ik(const IkOptions& options) {
  check_usage(options);
  std::vector<fs::path> inputs{options.scene};
  if (!options.workspace.empty()) inputs.emplace_back(options.workspace);
  if (!options.start_file().empty()) inputs.emplace_back(options.start_file());
  check_map_use(options, options, inputs);
  ProgressLine line;
  line.show(-1, "reading the scene");
  const Model model = requested_robot(options, inputs);
  const Search search = requested_search(model, options);
  check_outputs(options.outputs(), inputs, options.may_replace);
  line.show(-1, "assembling");
  catch_interrupt();
  const runs::Answers answers(model, options.map, options.polish);
  line.clear();
  const OutputFolders folders(options.outputs());
  for (const std::string& doubt : doubts_about(model, search.goals))
    std::fprintf(stderr, "softkin: warning: %s\n", doubt.c_str());
  if (!options.json) {
    print(head_text(model, options, answers));
    const std::vector<std::string> none;
    for (const auto* settings : {search.shape ? &none : &options.start, &options.prefer, &options.fix})
      print(curve_remarks(model, *settings));
  }
  return IkRun(model, answers, options, search).run();
}

}  // namespace

void add_ik(CLI::App& app, Run& run) {
  add_command(
      app, run, "ik", "Inverse kinematics: the actuation that brings markers where they should be",
      "Lengths are in mm whatever the scene's unit, pressures in kPa (gauge), tensions in N. Goals out of reach end "
      "at\n"
      "the nearest point that the ranges allow. Exit code: 0 reached, 1 not reached, not converged or interrupted,\n"
      "2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin ik examples/three_chamber_actuator/three_chamber_actuator.yaml --target tip=10,-5,140",
      add_options, run_ik);
}

}  // namespace softkin::cli
