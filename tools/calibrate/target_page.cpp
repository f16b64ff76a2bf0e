// The board as a page to print, from the runs of black cells in its raster.

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tools/atomic_output.h"
#include "tools/calibrate/target.h"

namespace zenith::tools {
namespace {

constexpr double kPointsPerMetre = 72.0 / 0.0254;
constexpr double kMargin_m = 0.012;
constexpr double kDotsPerInch = 300.0;

// PDF's page content: rectangles from the lower left corner, in points.
std::string page_content(const Target& target, double page_height_m) {
  const cv::Mat raster = target_raster(target);
  const double cell = target.square_m / Target::kCellsPerSquare;
  std::string content = "0 g\n";
  char line[160];
  for (int row = 0; row < raster.rows; ++row) {
    for (int begin = 0; begin < raster.cols;) {
      int end = begin;
      while (end < raster.cols && raster.at<std::uint8_t>(row, end) == 0) ++end;
      if (end == begin) {
        ++begin;
        continue;
      }
      // Rows overlap a little, or a thin white line shows between them.
      const double overlap = 0.01 * cell;
      std::snprintf(line, sizeof line, "%.4f %.4f %.4f %.4f re f\n",
                    (kMargin_m + begin * cell) * kPointsPerMetre,
                    (page_height_m - kMargin_m - (row + 1) * cell - overlap) * kPointsPerMetre,
                    (end - begin) * cell * kPointsPerMetre, (cell + overlap) * kPointsPerMetre);
      content += line;
      begin = end;
    }
  }
  std::snprintf(line, sizeof line,
                "BT /F1 8 Tf %.3f %.3f Td (Zenith: %s. Print at 100 %%, measure a square.) Tj ET\n",
                kMargin_m * kPointsPerMetre, 0.35 * kMargin_m * kPointsPerMetre,
                target_text(target).c_str());
  return content + line;
}

std::string pdf_page(const Target& target) {
  const double width_m = target.width_m() + 2.0 * kMargin_m;
  const double height_m = target.height_m() + 2.0 * kMargin_m;
  const std::string content = page_content(target, height_m);
  char box[96];
  std::snprintf(box, sizeof box, "[0 0 %.3f %.3f]", width_m * kPointsPerMetre,
                height_m * kPointsPerMetre);
  const std::vector<std::string> objects = {
      "<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
      std::string("<< /Type /Page /Parent 2 0 R /MediaBox ") + box +
          " /Contents 4 0 R /Resources << /Font << /F1 5 0 R >> >> >>",
      "<< /Length " + std::to_string(content.size()) + " >>\nstream\n" + content + "endstream",
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"};
  std::string file = "%PDF-1.4\n";
  std::string table;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    char entry[32];
    std::snprintf(entry, sizeof entry, "%010zu 00000 n \n", file.size());
    table += entry;
    file += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::string count = std::to_string(objects.size() + 1);
  const std::string begin = std::to_string(file.size());
  return file + "xref\n0 " + count + "\n0000000000 65535 f \n" + table + "trailer\n<< /Size " +
         count + " /Root 1 0 R >>\nstartxref\n" + begin + "\n%%EOF\n";
}

std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char c : bytes) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) * 0xEDB88320U);
  }
  return ~crc;
}

void add_big_endian(std::string& to, std::uint32_t value) {
  for (const unsigned shift : {24U, 16U, 8U, 0U}) to += static_cast<char>(value >> shift);
}

// The chunk that tells a PNG's resolution, behind its header of 33 bytes.
std::string with_resolution(const std::vector<std::uint8_t>& png, double dots_per_metre) {
  std::string chunk = "pHYs";
  add_big_endian(chunk, static_cast<std::uint32_t>(dots_per_metre + 0.5));
  add_big_endian(chunk, static_cast<std::uint32_t>(dots_per_metre + 0.5));
  chunk += '\1';  // a metre
  std::string file(png.begin(), png.begin() + 33);
  add_big_endian(file, static_cast<std::uint32_t>(chunk.size() - 4));
  file += chunk;
  add_big_endian(file, crc32(chunk));
  return file.append(png.begin() + 33, png.end());
}

// A whole number of dots a cell, so the resolution is near the usual one and exact.
std::string png_page(const Target& target) {
  const double cell_m = target.square_m / Target::kCellsPerSquare;
  const int dots = std::max(1, static_cast<int>(cell_m / 0.0254 * kDotsPerInch + 0.5));
  cv::Mat page;
  cv::resize(target_raster(target), page, {}, dots, dots, cv::INTER_NEAREST);
  const int margin = static_cast<int>(kMargin_m / cell_m * dots);
  cv::copyMakeBorder(page, page, margin, margin, margin, margin, cv::BORDER_CONSTANT,
                     cv::Scalar(255));
  std::vector<std::uint8_t> png;
  cv::imencode(".png", page, png);
  return with_resolution(png, dots / cell_m);
}

}  // namespace

Status write_target(const Target& target, const std::filesystem::path& path) {
  if (path.extension() == ".pdf") return write_file(path, pdf_page(target));
  if (path.extension() == ".png") return write_file(path, png_page(target));
  return Error{path.string() + ": expected a name that ends in .pdf or .png"};
}

}  // namespace zenith::tools
