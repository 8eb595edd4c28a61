// The subs of the macro files: loading them, and running them as if they were typed.
#include <algorithm>
#include <fmt/format.h>
#include <ranges>
#include <utility>

#include "server/machine/machine.h"

namespace cnc::server {

/// Homing as the macro files have it (HOM-3); nothing when they lack a sub for one of the axes.
std::optional<std::string> Machine::homing_subs(const std::vector<Axis>& axes, bool all) const {
  if (all && has_sub("home_all")) return "gosub home_all";
  std::string text;
  for (const Axis axis : axes) {
    const std::string sub = fmt::format("home_{}", axis_name(axis));
    if (!has_sub(sub)) return std::nullopt;
    text += fmt::format("gosub {}\n", sub);
  }
  return text;
}

/// `text` is not empty.
void Machine::run_text(std::string text, std::string name) {
  single_line_ = true;
  job_.start(interp::Program::from_text(std::move(text), std::move(name)).value(),
             JobControl::Kind::single_line);
  enter(State::mdi);
}

/// Reads the macro files again if one of them has changed. One that cannot be read is told, and
/// what was loaded before stays.
void Machine::load_macros() {
  std::vector<std::filesystem::file_time_type> times;
  for (const auto& path : data_.macro_files) {
    std::error_code missing;
    times.push_back(std::filesystem::last_write_time(path, missing));
  }
  if (times == macro_times_) return;
  macro_times_ = std::move(times);
  interp::Library macros;
  for (const auto& path : data_.macro_files) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) continue;
    auto program = interp::Program::open(path);
    if (!program) return log_.add(program.error());
    macros.push_back(std::move(*program));
  }
  use_macros(std::move(macros));
}

void Machine::use_macros(interp::Library macros) {
  macros_ = std::move(macros);
  interpreter_.set_library(macros_);
  constexpr std::size_t kTold = 10;
  const auto& warnings = interpreter_.library_warnings();
  for (const auto& warning : warnings | std::views::take(kTold))
    log_.add(Severity::warning, warning.to_error().to_string());
  if (warnings.size() > kTold)
    log_.add(Severity::warning,
             fmt::format("{} more remarks on the macro files.", warnings.size() - kTold));
}

bool Machine::has_sub(std::string_view name) const {
  return std::ranges::any_of(
      macros_, [&](const auto& macros) { return macros->flow().find_sub(name).mark != nullptr; });
}

}  // namespace cnc::server
