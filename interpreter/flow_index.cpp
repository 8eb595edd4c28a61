#include "interpreter/flow_index.h"

#include <algorithm>

#include "interpreter/line_parser.h"
#include "interpreter/number_scan.h"

namespace cnc::interp {
namespace {

/// Nearly all lines begin with another letter: this test is what indexing costs them.
[[nodiscard]] bool may_steer(std::string_view text) {
  for (const char c : text) {
    if (is_blank(c)) continue;
    switch (c) {
      case 'i':
      case 'I':
      case 'e':
      case 'E':
      case 'w':
      case 'W':
      case 's':
      case 'S':
      case 'n':
      case 'N':
      case '/':
        return true;
      default:
        return false;
    }
  }
  return false;
}

[[nodiscard]] std::string upper_name(std::string_view name) {
  std::string result(name);
  std::ranges::transform(result, result.begin(), upper);
  return result;
}

}  // namespace

bool FlowIndex::look_at(std::string_view text, std::uint32_t line, std::uint64_t offset) {
  if (!may_steer(text)) return true;
  const LineKeyword match_here = find_keyword(text);
  if (match_here.keyword == nullptr || !steers(match_here.keyword->statement)) return true;
  if (marks_.size() >= kMaxMarks) return false;
  const auto index = static_cast<std::uint32_t>(marks_.size());
  marks_.push_back({offset, line, FlowMark::kNoPartner, match_here.keyword->statement});
  if (match_here.keyword->statement == Statement::sub_begin) {
    add_sub(leading_name(match_here.rest), index);
  }
  match(index);
  return true;
}

void FlowIndex::match(std::uint32_t index) {
  switch (marks_[index].statement) {
    case Statement::if_begin:
    case Statement::while_begin:
    case Statement::sub_begin:
      open_.push_back(index);
      break;
    case Statement::if_else:
      // Takes the place of its if and waits for the endif.
      if (close(index, Statement::if_begin)) open_.push_back(index);
      break;
    case Statement::if_end:
      if (!close(index, Statement::if_else)) static_cast<void>(close(index, Statement::if_begin));
      break;
    case Statement::while_end:
      static_cast<void>(close(index, Statement::while_begin));
      break;
    case Statement::sub_end:
      static_cast<void>(close(index, Statement::sub_begin));
      break;
    default:
      break;
  }
}

// What does not fit stays without partner and is an error on its line when the program gets there.
bool FlowIndex::close(std::uint32_t index, Statement opener) {
  if (open_.empty() || marks_[open_.back()].statement != opener) return false;
  FlowMark& mark = marks_[index];
  marks_[open_.back()].partner = index;
  if (mark.statement != Statement::if_else) mark.partner = open_.back();
  open_.pop_back();
  return true;
}

void FlowIndex::add_sub(std::string_view name, std::uint32_t index) {
  const auto [entry, is_new] = subs_.try_emplace(upper_name(name), SubEntry{index});
  if (!is_new) entry->second.other_line = marks_[index].line;
}

const FlowMark* FlowIndex::find(std::uint32_t line) const {
  const auto mark = std::ranges::lower_bound(marks_, line, {}, &FlowMark::line);
  return mark != marks_.end() && mark->line == line ? &*mark : nullptr;
}

const FlowMark* FlowIndex::partner_of(const FlowMark& mark) const {
  return mark.partner == FlowMark::kNoPartner ? nullptr : &marks_[mark.partner];
}

FlowIndex::Sub FlowIndex::find_sub(std::string_view name) const {
  const auto entry = subs_.find(upper_name(name));
  if (entry == subs_.end()) return {};
  return {&marks_[entry->second.index], entry->second.other_line};
}

}  // namespace cnc::interp
