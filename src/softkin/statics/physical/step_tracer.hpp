#pragma once

#include <softkin/statics/physical/corrector.hpp>
#include <string>
#include <utility>

namespace softkin::physical {

/// Records the cost of each step of a continuation, and why it is taken or not, in SolveReport::trace.
class StepTracer {
 public:
  /// Both must outlive the object.
  StepTracer(bool on, const SolveRecord& record, std::vector<TracedStep>& trace)
      : on_(on), record_(record), trace_(trace) {}

  void begin(double from, double to, double length, const std::string& along = "") {
    if (!on_) return;
    step_ = {.from = from, .to = to, .length = length, .along = along};
    before_ = counts();
  }
  void end(bool taken, const std::string& why, double predicted_mm, double corrected_mm) {
    if (!on_) return;
    const Counts now = counts();
    step_.iterations = now.iterations - before_.iterations;
    step_.factorisations = now.factorisations - before_.factorisations;
    step_.factorisations_in_double = now.in_double - before_.in_double;
    step_.projections = now.projections - before_.projections;
    step_.shifts = now.shifts - before_.shifts;
    step_.predicted_mm = predicted_mm;
    step_.corrected_mm = corrected_mm;
    step_.taken = taken;
    step_.why = why;
    trace_.push_back(std::move(step_));
  }

 private:
  struct Counts {
    int iterations = 0, factorisations = 0, in_double = 0, projections = 0, shifts = 0;
  };
  [[nodiscard]] Counts counts() const {
    return {record_.iterations, record_.factorisations, record_.factorisations_in_double, record_.projections,
            record_.shifts};
  }

  bool on_;
  const SolveRecord& record_;
  std::vector<TracedStep>& trace_;
  TracedStep step_;
  Counts before_;
};

/// Base of classes that follow a path of equilibria: references to their common data.
class Follower {
 protected:
  /// All must outlive the object.
  Follower(Corrector& corrector, StepTracer& tracer, const Equilibria::Options& options)
      : corrector_(corrector),
        tracer_(tracer),
        options_(options),
        system_(corrector.system()),
        work_(corrector.work()),
        team_(corrector.team()),
        tuning_(corrector.work().options.path),
        record_(corrector.record()),
        report_(corrector.report()) {}

  Corrector& corrector_;
  StepTracer& tracer_;
  const Equilibria::Options& options_;
  const System& system_;
  Workspace& work_;
  Team& team_;
  const PathOptions& tuning_;
  SolveRecord& record_;
  SolveReport& report_;
};

}  // namespace softkin::physical
