#include "firmware/program/black_box_file.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "firmware/diagnostics/output_file.h"
#include "firmware/diagnostics/tick_csv.h"

namespace stilt::program {
namespace {

/// From the trigger on: what is before may be of an earlier fault.
supervisor::Reaction hardest(const control_loop::TickBlackBox& box) noexcept {
  auto reaction = supervisor::Reaction::none;
  for (std::size_t i = box.trigger(); i < box.size(); ++i)
    reaction = std::max(reaction, box.record(i).reaction);
  return reaction;
}

/// Moves the files of earlier runs on: box.csv to box.1.csv, that one to box.2.csv. Links and devices stay.
void keep_earlier(const std::string& file) {
  constexpr int kKept = 9;
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::symlink_status(file, ignored).type() != fs::file_type::regular) return;
  const std::string ending = fs::path(file).extension();
  const auto aged = [&](int age) {
    return age == 0 ? fs::path(file) : fs::path(file).replace_extension(std::to_string(age) + ending);
  };
  for (int age = kKept; age > 0; --age) fs::rename(aged(age - 1), aged(age), ignored);
}

}  // namespace

BlackBoxFile::BlackBoxFile(const Options& options, ControllerState& state)
    : options_(options), state_(state) {
  state_.mail.black_box.set_aftermath(control_loop::kBlackBoxRecords / 4);
}

void BlackBoxFile::save() {
  if (options_.black_box_file.empty() || !state_.mail.black_box.frozen()) return;
  write();
  state_.mail.black_box.rearm();
}

std::expected<void, std::string> BlackBoxFile::finish() {
  save();
  if (!options_.black_box_file.empty() && state_.mail.black_box.cut_short()) write();
  if (written_) static_cast<void>(diagnostics::wait_for_disk(options_.black_box_file));
  if (!complaint_.empty()) return std::unexpected(complaint_);
  return {};
}

void BlackBoxFile::write() {
  const control_loop::TickBlackBox& box = state_.mail.black_box;
  const supervisor::Reaction reaction = hardest(box);
  if (written_ && reaction <= *written_) return;
  if (!std::exchange(earlier_kept_, true)) keep_earlier(options_.black_box_file);
  const auto written = diagnostics::write_csv(options_.black_box_file, box, state_.start_ns);
  if (!written) {
    complaint_ = "--black-box " + written.error() + "; name a file in a writable folder";
    std::fprintf(stderr, "%s\n", complaint_.c_str());
    lost_ = std::max(lost_, reaction);
    return;
  }
  std::fprintf(stderr, "black box written to %s\n", options_.black_box_file.c_str());
  written_ = reaction;
  if (reaction >= lost_) complaint_.clear();
}

}  // namespace stilt::program
