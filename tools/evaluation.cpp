#include "tools/evaluation.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>

#include "tools/runner/simulated_source.h"
#include "tools/runner/team_run.h"

namespace zenith::tools {
namespace {

// Sums the progress of the runs, which threads report side by side.
class SharedProgress {
 public:
  SharedProgress(std::size_t runs, const EvaluationEvents& events)
      : fractions_(runs, 0.0), events_(events) {}

  void report(std::size_t run, double fraction) {
    const std::scoped_lock lock(mutex_);
    sum_ += fraction - fractions_[run];
    fractions_[run] = fraction;
    if (events_.progress) events_.progress(sum_ / static_cast<double>(fractions_.size()));
  }

  void finish(std::size_t run, const EvaluationRun& result) {
    report(run, 1.0);
    const std::scoped_lock lock(mutex_);
    if (events_.done) events_.done(result);
  }

 private:
  std::mutex mutex_;
  std::vector<double> fractions_;
  double sum_ = 0.0;
  const EvaluationEvents& events_;
};

void evaluate_one(const EvaluationPlan& plan, EvaluationRun& run, const RunProgress& progress) {
  auto team = simulate_team(run.world, run.seed, plan.duration_s, plan.parameters);
  if (!team.ok()) {
    run.failure = team.error().message;
    return;
  }
  const auto log =
      run_team(team->sources, {plan.parameters, run.seed, plan.sharing, plan.joint}, progress);
  if (!log.ok()) {
    run.failure = log.error().message;
    return;
  }
  run.figures = judge(*log);
  run.joint = log->joint;
}

std::vector<EvaluationRun> list_runs(const EvaluationPlan& plan) {
  std::vector<EvaluationRun> runs;
  for (const std::string& world : plan.worlds) {
    for (int i = 0; i < plan.seeds; ++i) {
      EvaluationRun run;
      run.world = world;
      run.seed = plan.first_seed + static_cast<std::uint64_t>(i);
      runs.push_back(std::move(run));
    }
  }
  return runs;
}

}  // namespace

std::vector<EvaluationRun> evaluate(const EvaluationPlan& plan, const EvaluationEvents& events) {
  std::vector<EvaluationRun> runs = list_runs(plan);
  SharedProgress shared(runs.size(), events);
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < runs.size(); i = next++) {
      evaluate_one(plan, runs[i], [&](int done, int total) {
        if (done % 16 == 0) shared.report(i, static_cast<double>(done) / total);
      });
      shared.finish(i, runs[i]);
    }
  };
  std::vector<std::jthread> threads;
  const int extra = std::min(plan.jobs, static_cast<int>(runs.size())) - 1;
  for (int i = 0; i < extra; ++i) threads.emplace_back(work);
  work();
  threads.clear();
  return runs;
}

}  // namespace zenith::tools
