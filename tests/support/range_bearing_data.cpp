#include "tests/support/range_bearing_data.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

namespace zenith {
namespace {

using Rows = std::vector<std::vector<double>>;

// Numbers of all lines but comments; each line must hold `columns` of them.
Result<Rows> read_rows(const std::filesystem::path& file, std::size_t columns) {
  std::ifstream in(file);
  if (!in) return Error{"cannot open " + file.string()};
  Rows rows;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos || line.front() == '#') continue;
    std::istringstream fields(line);
    std::vector<double> row(columns);
    for (double& value : row) fields >> value;
    std::string rest;
    if (!fields || fields >> rest) {
      return Error{file.string() + ":" + std::to_string(number) + ": expected " +
                   std::to_string(columns) + " numbers, found: " + line};
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Status check_order(const Rows& rows, const std::filesystem::path& file) {
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i][0] < rows[i - 1][0]) {
      return Error{file.string() + ": times fall at row " + std::to_string(i + 1)};
    }
  }
  return {};
}

Result<Rows> read_timed_rows(const std::filesystem::path& file, std::size_t columns) {
  Result<Rows> rows = read_rows(file, columns);
  if (!rows) return rows;
  const Status order = check_order(*rows, file);
  if (!order) return order.error();
  return rows;
}

Status load_robot(const std::filesystem::path& folder, const std::string& name,
                  const std::map<int, int>& subject_of_barcode, RangeBearingRobot& robot) {
  const Result<Rows> odometry = read_timed_rows(folder / (name + "_Odometry.dat"), 3);
  if (!odometry) return odometry.error();
  for (const auto& row : *odometry) robot.odometry.push_back({row[0], row[1], row[2]});

  const Result<Rows> measurements = read_timed_rows(folder / (name + "_Measurement.dat"), 4);
  if (!measurements) return measurements.error();
  for (const auto& row : *measurements) {
    const auto found = subject_of_barcode.find(static_cast<int>(row[1]));
    if (found == subject_of_barcode.end()) {
      ++robot.unknown_barcodes;
    } else {
      robot.measurements.push_back({row[0], found->second, row[2], row[3]});
    }
  }

  const Result<Rows> truth = read_timed_rows(folder / (name + "_Groundtruth.dat"), 4);
  if (!truth) return truth.error();
  for (const auto& row : *truth) robot.truth.push_back({row[0], {row[1], row[2], row[3]}});
  return {};
}

}  // namespace

Result<RangeBearingData> load_range_bearing(const std::filesystem::path& folder) {
  RangeBearingData data;
  const Result<Rows> barcodes = read_rows(folder / "Barcodes.dat", 2);
  if (!barcodes) return barcodes.error();
  std::map<int, int> subject_of_barcode;
  for (const auto& row : *barcodes) {
    subject_of_barcode[static_cast<int>(row[1])] = static_cast<int>(row[0]);
  }
  const Result<Rows> landmarks = read_rows(folder / "Landmark_Groundtruth.dat", 5);
  if (!landmarks) return landmarks.error();
  for (const auto& row : *landmarks) {
    data.landmarks_m[static_cast<int>(row[0])] = Eigen::Vector2d(row[1], row[2]);
  }
  for (int i = 0; i < kMrclamRobots; ++i) {
    const Status status = load_robot(folder, "Robot" + std::to_string(i + 1), subject_of_barcode,
                                     data.robots[static_cast<std::size_t>(i)]);
    if (!status) return status.error();
  }
  return data;
}

bool truth_at(const std::vector<TruthSample>& truth, double time_s, Pose2& pose) {
  const auto after =
      std::lower_bound(truth.begin(), truth.end(), time_s,
                       [](const TruthSample& sample, double time) { return sample.time_s < time; });
  if (after == truth.begin() || after == truth.end()) return false;
  const TruthSample& b = *after;
  const TruthSample& a = *(after - 1);
  constexpr double kLargestGap = 0.5;
  if (b.time_s - a.time_s > kLargestGap) return false;
  const double s = (time_s - a.time_s) / (b.time_s - a.time_s);
  const double turn = wrap_angle(b.pose.theta_rad - a.pose.theta_rad);
  pose = {a.pose.x_m + s * (b.pose.x_m - a.pose.x_m), a.pose.y_m + s * (b.pose.y_m - a.pose.y_m),
          wrap_angle(a.pose.theta_rad + s * turn)};
  return true;
}

}  // namespace zenith
