#include "interpreter/sources.h"

namespace cnc::interp {

void Sources::set_library(const Library& library) {
  files_.resize(1);
  files_.insert(files_.end(), library.begin(), library.end());
}

Sources::Sub Sources::find_sub(std::string_view name) const {
  const auto in_file = [&](std::uint16_t index) -> Sub {
    const FlowIndex::Sub sub = files_[index]->flow().find_sub(name);
    return {index, sub.mark, sub.other_line};
  };
  if (has_job()) {
    if (const Sub sub = in_file(kJob); sub.begin != nullptr) return sub;
  }
  for (auto index = static_cast<std::uint16_t>(count() - 1); index > kJob; --index) {
    if (const Sub sub = in_file(index); sub.begin != nullptr) return sub;
  }
  return {};
}

}  // namespace cnc::interp
