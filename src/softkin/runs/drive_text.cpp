#include <softkin/core/text.hpp>
#include <softkin/drive/use.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/runs/drive_text.hpp>

namespace softkin::runs {

namespace {

Column drive_column(const std::string& title, bool left) {
  return {.key = title, .left = left};
}

std::string range_text(double low, double high) {
  return decimal(low, 2) + " to " + decimal(high, 2);
}

}  // namespace

Table tendon_table(const drive::Plan& plan) {
  Table table{{drive_column("tendon", true), drive_column("axis", true), drive_column("length [mm]", false),
               drive_column("limits [mm]", false), drive_column("steps from home", false),
               drive_column("drum turns", false), drive_column("speed [mm/s]", false),
               drive_column("limit [mm/s]", false)}};
  for (std::size_t i = 0; i < plan.machine.tendons.size(); ++i) {
    const drive::Tendon& tendon = plan.machine.tendons[i];
    const drive::TendonUse use = drive::use_of(plan, i);
    table.rows.push_back(
        {printable(tendon.name), std::string(1, tendon.axis), range_text(use.shortest_mm, use.longest_mm),
         range_text(tendon.shortest_mm, tendon.longest_mm),
         std::to_string(use.lowest) + " to " + std::to_string(use.highest), use.turns ? decimal(*use.turns, 2) : "-",
         decimal(use.fastest_mm_per_s, 2), decimal(tendon.max_speed_mm_per_s, 2)});
  }
  return table;
}

Table syringe_table(const drive::Plan& plan) {
  Table table{{drive_column("syringe", true), drive_column("axis", true), drive_column("ratio [-]", false),
               drive_column("pressure [kPa]", false), drive_column("plunger [mm]", false),
               drive_column("limits [mm]", false), drive_column("steps from home", false),
               drive_column("speed [mm/s]", false), drive_column("limit [mm/s]", false)}};
  for (std::size_t i = 0; i < plan.machine.syringes.size(); ++i) {
    const drive::Syringe& syringe = plan.machine.syringes[i];
    const drive::SyringeUse use = drive::use_of_syringe(plan, i);
    const bool pushed = syringe.by_pushed_mL;
    table.rows.push_back({printable(syringe.name), std::string(1, syringe.axis),
                          pushed ? "-" : decimal(use.lowest_ratio, 4) + " to " + decimal(use.highest_ratio, 4),
                          pushed ? "-" : range_text(use.lowest_kpa, use.highest_kpa),
                          range_text(use.lowest_mm, use.highest_mm), range_text(syringe.lowest_mm, syringe.highest_mm),
                          std::to_string(use.lowest) + " to " + std::to_string(use.highest),
                          decimal(use.fastest_mm_per_s, 2), decimal(syringe.max_speed_mm_per_s, 2)});
  }
  return table;
}

Table plunger_table(const drive::Plan& plan) {
  Table table{{drive_column("row", false)}};
  if (plan.motion.timed) table.columns.push_back(drive_column("t [s]", false));
  for (std::size_t i = 0; i < plan.machine.syringes.size(); ++i) {
    const std::string name = printable(plan.machine.syringes[i].name);
    const std::vector<const char*> titles =
        plan.machine.syringes[i].by_pushed_mL
            ? std::vector{" [mL]", "plunger [mm]", "out of the syringe [mL]"}
            : std::vector{" [-]", "pressure [kPa]", "out of the syringe [mL]", "plunger [mm]", "leads to [-]"};
    for (const char* title : titles)
      table.columns.push_back(drive_column(title[0] == ' ' ? name + title : title, false));
  }
  for (const CommandRow& row : plan.commands.rows) {
    table.rows.push_back({std::to_string(row.line)});
    if (plan.motion.timed) table.rows.back().push_back(number(*row.time_s, 6));
  }
  constexpr double mm3_per_ml = 1000;
  for (std::size_t i = 0; i < plan.machine.syringes.size(); ++i) {
    const std::vector<drive::PlungerRow> rows = drive::plunger_rows(plan, i);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const std::string requested = decimal(rows[k].ratio, 5), out = decimal(rows[k].volume_mm3 / mm3_per_ml, 4),
                        plunger = decimal(rows[k].plunger_mm, 4);
      const auto cells = plan.machine.syringes[i].by_pushed_mL ? std::vector{requested, plunger, out}
                                                               : std::vector{requested, decimal(rows[k].gauge_kpa, 3),
                                                                             out, plunger, decimal(rows[k].reached, 5)};
      table.rows[k].insert(table.rows[k].end(), cells.begin(), cells.end());
    }
  }
  return table;
}

Table chamber_table(const drive::Plan& plan) {
  Table table{{drive_column("chamber", true), drive_column("channel", true), drive_column("pressure [kPa]", false),
               drive_column("limits [kPa]", false)}};
  for (std::size_t i = 0; i < plan.machine.chambers.size(); ++i) {
    const drive::Chamber& chamber = plan.machine.chambers[i];
    const auto [low, high] = drive::pressure_range(plan, i);
    table.rows.push_back({printable(chamber.name), printable(chamber.channel), range_text(low, high),
                          range_text(chamber.low_kpa, chamber.high_kpa)});
  }
  return table;
}

std::string times_text(const drive::Plan& plan) {
  std::string text = counted(plan.commands.rows.size(), "row");
  if (plan.motion.timed)
    text += ", " + number(*plan.commands.rows.back().time_s - *plan.commands.rows.front().time_s, 6) + " s";
  else if (plan.has_motors())
    text += " without times: " + number(plan.motion.seconds, 4) + " s at the approach speed of " +
            number(plan.machine.approach_speed_mm_per_s) + " mm/s";
  if (!plan.has_motors()) return text;
  text += ", after an approach of " + number(drive::seconds_of(plan.motion.approach), 4) + " s from home";
  if (!plan.motion.back.empty())
    text += "; the return home takes " + number(drive::seconds_of(plan.motion.back), 4) + " s";
  return text + "; " + counted(plan.program.lines.size(), "line") + " of G-code";
}

std::string stream_text(const std::string& commands, const drive::GcodeProgram& program,
                        const drive::StreamReport& report) {
  std::string text = report.message;
  const auto row_of = [&](std::size_t line) {
    const std::size_t row = program.lines[line - 1].row;
    return row > 0 ? " (" + commands + ":" + std::to_string(row) + ")" : "";
  };
  if (report.end != drive::StreamEnd::finished) {
    text += "; the board accepted " + (report.acknowledged > 0 ? "lines up to " + std::to_string(report.acknowledged) +
                                                                     row_of(report.acknowledged)
                                                               : std::string("no line"));
    text += " of " + std::to_string(report.lines);
    if (report.sent > report.acknowledged) text += ", and perhaps those up to " + std::to_string(report.sent);
  }
  if (report.position_known) {
    text += "; the motors stand at";
    for (std::size_t i = 0; i < report.position.size(); ++i)
      text += std::string(" ") + program.axes[i] + " " + decimal(report.position[i], 3);
    text += " mm";
  } else if (report.sent > 0) {
    text += "; bring the motors home by hand before the next run";
  }
  return text;
}

}  // namespace softkin::runs
