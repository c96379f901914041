#include "firmware/program/black_box_file.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "firmware/diagnostics/tick_csv.h"

namespace stilt::program {
namespace {

supervisor::Reaction hardest(const control_loop::TickBlackBox& box) noexcept {
  auto reaction = supervisor::Reaction::none;
  for (std::size_t i = 0; i < box.size(); ++i) reaction = std::max(reaction, box.record(i).reaction);
  return reaction;
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

void BlackBoxFile::finish() {
  save();
  if (!options_.black_box_file.empty() && state_.mail.black_box.cut_short()) write();
}

void BlackBoxFile::write() {
  const control_loop::TickBlackBox& box = state_.mail.black_box;
  const supervisor::Reaction reaction = hardest(box);
  if (reaction < written_) return;
  const auto written = diagnostics::write_csv(options_.black_box_file, box, state_.start_ns);
  const std::string said = written ? "black box written to " + options_.black_box_file : written.error();
  std::fprintf(stderr, "%s\n", said.c_str());
  written_ = reaction;
}

}  // namespace stilt::program
