#include "interpreter/parameter_names.h"

#include <algorithm>
#include <fmt/format.h>

#include "interpreter/number_scan.h"

namespace cnc::interp {
namespace {

[[nodiscard]] bool can_stand_in_name(char c) {
  return is_letter(c) || is_digit(c) || c == '_' || c == '-' || c == '.' ||
         static_cast<unsigned char>(c) >= 0x80;
}

/// Without blanks and in lower case.
[[nodiscard]] std::string normal_form(std::string_view written) {
  std::string name;
  for (const char c : written) {
    if (is_blank(c)) continue;
    name += 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return name;
}

}  // namespace

Parsed<std::int32_t> ParameterNames::id_of(std::string_view written, Span span) {
  std::string name = normal_form(written);
  if (const auto known = ids_.find(name); known != ids_.end()) return known->second;
  if (name.empty() || !std::ranges::all_of(name, can_stand_in_name)) {
    return refuse(ErrorCode::name_expected, span,
                  fmt::format("\"{}\" is not the name of a parameter.", written),
                  "Letters, digits and underscores: #<depth>.");
  }
  if (entries_.size() >= kMaxNames) {
    return refuse(ErrorCode::too_many_names, span, "Too many named parameters.",
                  fmt::format("At most {}.", kMaxNames));
  }
  const auto id = kFirstId + static_cast<std::int32_t>(entries_.size());
  entries_.push_back({.name = name, .is_global = name.front() == '_'});
  ids_.emplace(std::move(name), id);
  return id;
}

std::optional<double> ParameterNames::find(std::int32_t id) const {
  const Entry& found = entry(id);
  const bool is_set = found.is_global ? found.set_at != kUnset : found.set_at == depth_;
  return is_set ? std::optional(found.value) : std::nullopt;
}

void ParameterNames::set(std::int32_t id, double value) {
  Entry& changed = entries_.at(index(id));
  if (!changed.is_global && changed.set_at != depth_) {
    covered_.push_back({index(id), changed.value, changed.set_at});
  }
  changed.value = value;
  changed.set_at = depth_;
}

void ParameterNames::enter_sub() {
  calls_.push_back(covered_.size());
  ++depth_;
}

void ParameterNames::leave_sub() {
  for (; covered_.size() > calls_.back(); covered_.pop_back()) {
    const Covered& before = covered_.back();
    entries_[before.index].value = before.value;
    entries_[before.index].set_at = before.set_at;
  }
  calls_.pop_back();
  --depth_;
}

void ParameterNames::forget_locals() {
  covered_.clear();
  calls_.clear();
  depth_ = kOutside;
  if (std::erase_if(entries_, [](const Entry& gone) { return !gone.is_global; }) == 0) return;
  ids_.clear();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    ids_.emplace(entries_[i].name, kFirstId + static_cast<std::int32_t>(i));
  }
}

}  // namespace cnc::interp
