// What the operator can ask of the machine, as values.
//
// A widget says what is wanted and emits it; the Connection carries it out. So no widget knows the
// network, and a test sees exactly what a key or a button asked for.
#pragma once

#include <QMetaType>
#include <QString>
#include <string>
#include <variant>
#include <vector>

#include "api/axis.h"
#include "api/client.h"

namespace cnc::gui {

struct Reset {};
struct Home {
  std::vector<api::Axis> axes;  ///< none: all
};
struct AcceptPosition {
  std::vector<api::Axis> axes;
};
struct Mdi {
  std::string line;
};
struct Load {
  std::string path;  ///< on the server's computer
};
struct Run {};
struct Pause {};
struct Resume {};
struct Stop {};
struct Rewind {};
struct SetOverrides {
  api::OverrideChange change;
};
struct SetWorkZero {
  std::vector<api::WorkCoordinate> coordinates;
};
struct JogStep {
  api::Axis axis = api::Axis::X;
  double distance = 0.0;  ///< mm or degrees, signed
};

struct RunSub {
  std::string name;  ///< of the macro files
};
struct Answer {
  std::uint64_t question = 0;  ///< its number
  bool confirmed = false;      ///< OK; false = Cancel
  std::vector<double> values;
};

using Request = std::variant<Reset, Home, AcceptPosition, Mdi, Load, Run, Pause, Resume, Stop,
                             Rewind, SetOverrides, SetWorkZero, JogStep, RunSub, Answer>;

/// "Home", for messages: "Home: …".
[[nodiscard]] QString request_name(const Request& request);

}  // namespace cnc::gui

Q_DECLARE_METATYPE(cnc::gui::Request)
