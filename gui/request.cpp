#include "gui/request.h"

#include <array>

namespace cnc::gui {
namespace {

constexpr std::array<const char*, std::variant_size_v<Request>> kNames{
    "Reset", "Home",   "Accept position", "Single line", "Load", "Run",      "Pause", "Resume",
    "Stop",  "Rewind", "Override",        "Work zero",   "Jog",  "User key", "Answer"};

}  // namespace

QString request_name(const Request& request) {
  return QString::fromLatin1(kNames.at(request.index()));
}

}  // namespace cnc::gui
