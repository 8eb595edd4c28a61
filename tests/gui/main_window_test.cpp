// The screen as a whole: what is possible, what a key asks for, and what is left without a machine.
#include "gui/main_window.h"

#include <catch2/catch.hpp>

#include "gui/job_panel.h"
#include "gui/style.h"
#include "tests/gui/support.h"

namespace cnc::gui::test {
namespace {

using api::Axis;
using api::Command;
using api::MachineState;

struct Screen {
  QApplication& app = application();
  MainWindow window{QStringLiteral("unix:///run/cnc.sock"), true};
  std::vector<Request> requests;

  Screen() {
    QObject::connect(&window, &MainWindow::requested, &window,
                     [this](const Request& request) { requests.push_back(request); });
    window.resize(1024, 768);
    show_active(window);
  }

  void connect(const api::MachineStatus& status) {
    window.show_connected(facts_with({Axis::X, Axis::Y, Axis::Z}));
    window.show_status(status);
  }
  [[nodiscard]] QPushButton& button(const char* name) { return child<QPushButton>(window, name); }
};

api::MachineStatus ready() {
  return status_with(
      MachineState::ready,
      {Command::reset, Command::home, Command::jog, Command::mdi, Command::load, Command::run,
       Command::rewind, Command::override_rates, Command::set_work_zero});
}

}  // namespace

TEST_CASE("A key is enabled exactly when the server allows its command, and else says why",
          "[gui][GUI-2]") {
  struct Row {
    const char* name;
    Command command;
  };
  const auto row = GENERATE(
      Row{"reset", Command::reset}, Row{"home_all", Command::home}, Row{"home_X", Command::home},
      Row{"X_plus", Command::jog}, Row{"mdi_send", Command::mdi}, Row{"load", Command::load},
      Row{"run", Command::run}, Row{"pause", Command::pause}, Row{"stop", Command::stop},
      Row{"rewind", Command::rewind}, Row{"Feed_more", Command::override_rates},
      Row{"zero_Z", Command::set_work_zero});
  CAPTURE(row.name);
  Screen screen;
  screen.connect(status_with(MachineState::ready, {row.command}));
  CHECK(screen.button(row.name).isEnabled());
  CHECK(screen.button(row.name).toolTip().isEmpty());

  screen.window.show_status(status_with(MachineState::needs_homing, {}));
  CHECK_FALSE(screen.button(row.name).isEnabled());
  CHECK(screen.button(row.name).toolTip() == kRefusal);
}

TEST_CASE("The run key names what it will do next", "[gui][GUI-2]") {
  auto status = status_with(MachineState::ready, {Command::run});
  CHECK(run_key(status).text == "Run");
  CHECK(std::holds_alternative<Run>(run_key(status).request));

  status = status_with(MachineState::paused, {Command::resume});
  CHECK(run_key(status).text == "Resume");
  CHECK(std::holds_alternative<Resume>(run_key(status).request));

  status = status_with(MachineState::program_stop, {Command::resume});
  CHECK(run_key(status).text == "Continue");

  status = status_with(MachineState::tool_change, {Command::resume});
  status.selected_tool = 3;
  CHECK(run_key(status).text.simplified() == "Continue with T3");
  CHECK(std::holds_alternative<Resume>(run_key(status).request));

  status = status_with(MachineState::needs_homing, {});
  CHECK(run_key(status).text == "Run");
  CHECK_FALSE(run_key(status).availability.allowed);
}

TEST_CASE("Without a server everything is grey and the screen says so", "[gui][GUI-2]") {
  Screen screen;
  const auto check_that_nothing_is_possible = [&] {
    for (const char* const name : {"reset", "home_all", "load", "run", "pause", "stop", "zero_X",
                                   "X_plus", "Feed_more", "mdi_send"}) {
      CAPTURE(name);
      CHECK_FALSE(screen.button(name).isEnabled());
    }
    CHECK(child<QLabel>(screen.window, "state_text").text().toStdString() ==
          "Not connected to unix:///run/cnc.sock — trying again");
  };
  check_that_nothing_is_possible();

  screen.connect(ready());
  REQUIRE(screen.button("run").isEnabled());
  screen.window.jog_lease().hold(Qt::Key_Right, {Axis::X, 0.1});
  REQUIRE(screen.window.jog_lease().is_holding());

  screen.window.show_disconnected(QStringLiteral("gone"));
  check_that_nothing_is_possible();
  CHECK_FALSE(screen.window.jog_lease().is_holding());

  screen.connect(ready());
  CHECK(screen.button("run").isEnabled());
}

TEST_CASE("F1 resets and Esc pauses, even while a line is typed", "[gui][GUI-5]") {
  Screen screen;
  screen.connect(ready());
  child<QLineEdit>(screen.window, "mdi").setFocus();
  send_key(screen.window, QEvent::KeyPress, Qt::Key_F1);
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Escape);
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Escape, Qt::NoModifier, true);
  CHECK(only<Reset>(screen.requests).size() == 1);
  CHECK(only<Pause>(screen.requests).size() == 1);
}

TEST_CASE("Positions, homed marks and the zero keys belong to the visible axes", "[gui][GUI-2]") {
  Screen screen;
  screen.window.show_connected(facts_with({Axis::X, Axis::Z}));
  auto status = ready();
  status.work_position[Axis::X] = -12.3456;
  status.machine_position[Axis::X] = 100.0;
  status.trust[Axis::X] = api::PositionTrust::trusted;
  screen.window.show_status(status);
  CHECK(child<ReadOut>(screen.window, "work_X").text().toStdString() == "−12.346");
  CHECK(child<QLabel>(screen.window, "machine_X").text().startsWith("100.000"));
  CHECK(child<QLabel>(screen.window, "machine_Z").text().simplified() == "not homed");
  status.trust[Axis::X] = api::PositionTrust::doubtful;
  screen.window.show_status(status);
  CHECK(child<QLabel>(screen.window, "machine_X").text().simplified() == "100.000 doubtful");
  CHECK(screen.button("home_X").text().toStdString() == "⌂?");
  CHECK(wait_until([&] { return screen.window.findChild<ReadOut*>("work_Y") == nullptr; }));

  screen.button("zero_Z").click();
  const auto zeros = only<SetWorkZero>(screen.requests);
  REQUIRE(zeros.size() == 1);
  REQUIRE(zeros.front().coordinates.size() == 1);
  CHECK(zeros.front().coordinates.front().axis == Axis::Z);
  CHECK(zeros.front().coordinates.front().value == 0.0);

  screen.button("home_X").click();
  REQUIRE(only<Home>(screen.requests).size() == 1);
  CHECK(only<Home>(screen.requests).front().axes == std::vector{Axis::X});
}

TEST_CASE("Positions in doubt are accepted by a key that is held, and only those", "[gui][STA-4]") {
  Screen screen;
  auto status = status_with(MachineState::needs_homing, {Command::accept_position});
  status.trust[Axis::X] = api::PositionTrust::trusted;
  status.trust[Axis::Y] = api::PositionTrust::doubtful;  // Z was never homed
  screen.connect(status);
  auto& key = screen.button("accept_position");
  CHECK(key.isVisible());
  const QPoint middle = key.rect().center();

  send_mouse(key, QEvent::MouseButtonPress, middle);
  send_mouse(key, QEvent::MouseButtonRelease, middle);
  CHECK_FALSE(wait_until([&] { return !only<AcceptPosition>(screen.requests).empty(); },
                         std::chrono::milliseconds(1500)));

  // What comes into doubt while it is held has not been looked at.
  send_mouse(key, QEvent::MouseButtonPress, middle);
  auto worse = status;
  worse.trust[Axis::X] = api::PositionTrust::doubtful;
  screen.window.show_status(worse);
  CHECK_FALSE(wait_until([&] { return !only<AcceptPosition>(screen.requests).empty(); },
                         std::chrono::milliseconds(1500)));
  send_mouse(key, QEvent::MouseButtonRelease, middle);
  screen.window.show_status(status);

  const QRect home = screen.button("home_all").geometry();
  send_mouse(key, QEvent::MouseButtonPress, middle);
  CHECK(wait_until([&] { return !only<AcceptPosition>(screen.requests).empty(); }));
  send_mouse(key, QEvent::MouseButtonRelease, middle);
  const auto accepted = only<AcceptPosition>(screen.requests);
  REQUIRE(accepted.size() == 1);
  CHECK(accepted.front().axes == std::vector{Axis::Y});

  status.trust[Axis::Y] = api::PositionTrust::trusted;
  screen.window.show_status(status);
  CHECK_FALSE(key.isVisible());
  CHECK(screen.button("home_all").geometry() == home);
}

TEST_CASE("Override keys step by ten per cent, within the limits, and back to 100 %",
          "[gui][GUI-2]") {
  Screen screen;
  auto status = ready();
  status.feed_override = 0.95;
  status.rapid_override = 1.0;
  screen.connect(status);
  screen.button("Feed_more").click();   // to the next whole step: 100 %
  screen.button("Feed_more").click();   // 110 %, though no status came between
  screen.button("Feed_value").click();  // 100 %
  screen.button("Rapid_more").click();  // stays at its limit
  const auto sets = only<SetOverrides>(screen.requests);
  REQUIRE(sets.size() == 4);
  CHECK(sets[0].change.feed.value() == Approx(1.0));
  CHECK_FALSE(sets[0].change.rapid.has_value());
  CHECK(sets[1].change.feed.value() == Approx(1.1));
  CHECK(sets[2].change.feed.value() == Approx(1.0));
  CHECK(sets[3].change.rapid.value() == Approx(1.0));
}

TEST_CASE("A single line is sent by Enter and comes back with the up key", "[gui][MAN-5]") {
  Screen screen;
  screen.connect(ready());
  auto& editor = child<QLineEdit>(screen.window, "mdi");
  editor.setFocus();
  editor.setText("G0 X10");
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Return);
  REQUIRE(only<Mdi>(screen.requests).size() == 1);
  CHECK(only<Mdi>(screen.requests).front().line == "G0 X10");
  CHECK(editor.text().isEmpty());
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Up);
  CHECK(editor.text() == "G0 X10");
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Down);
  CHECK(editor.text().isEmpty());
}

TEST_CASE("A line that the machine cannot execute now is kept in the editor", "[gui][MAN-5]") {
  Screen screen;
  screen.connect(status_with(MachineState::running, {Command::pause}));
  auto& editor = child<QLineEdit>(screen.window, "mdi");
  editor.setFocus();
  editor.setText("G0 X10");
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Return);
  CHECK(screen.requests.empty());
  CHECK(editor.text() == "G0 X10");
}

TEST_CASE("A file given at the start is loaded once, when the machine allows it", "[gui][GUI-2]") {
  Screen screen;
  screen.window.load_when_ready("/jobs/part.nc");
  screen.connect(status_with(MachineState::running, {Command::pause}));
  CHECK(screen.requests.empty());
  screen.window.show_status(ready());
  screen.window.show_status(ready());
  REQUIRE(only<Load>(screen.requests).size() == 1);
  CHECK(only<Load>(screen.requests).front().path == "/jobs/part.nc");
}

TEST_CASE("An error stays in the message line until it has been seen", "[gui][GUI-2]") {
  Screen screen;
  screen.window.show_message({.sequence = 1,
                              .time = {},
                              .severity = api::Severity::error,
                              .text = "Soft limit of X reached.",
                              .error = {}});
  screen.window.show_message({.sequence = 2,
                              .time = {},
                              .severity = api::Severity::info,
                              .text = "Job loaded.",
                              .error = {}});
  auto& line = child<QLabel>(screen.window, "message_line");
  CHECK(line.text() == "Soft limit of X reached.");
  CHECK(child<QLabel>(screen.window, "message_mark").text().endsWith("2"));
  CHECK(child<QListWidget>(screen.window, "message_list").count() == 2);

  screen.button("message_seen").click();
  CHECK(line.text().isEmpty());
  screen.window.show_message({.sequence = 3,
                              .time = {},
                              .severity = api::Severity::info,
                              .text = "Job ended.",
                              .error = {}});
  CHECK(line.text() == "Job ended.");
}

TEST_CASE("A refused command is shown with its reason", "[gui][GUI-2]") {
  Screen screen;
  api::Error error;
  error.kind = api::ErrorKind::refused;
  error.code = 5001;
  error.message = "home is not possible in state \"estop\".";
  screen.window.show_refusal(Home{}, error);
  const QString line = child<QLabel>(screen.window, "message_line").text();
  CHECK(line.startsWith("Home: "));
  CHECK(line.contains("estop"));
}

TEST_CASE("Everything fits on 1024 x 768, with three axes and with six", "[gui][GUI-10]") {
  set_up_look(application());  // with the sizes that the operator gets
  Screen screen;
  const auto axes = GENERATE(3U, 6U);
  MachineFacts facts = facts_with({Axis::X, Axis::Y, Axis::Z, Axis::A, Axis::B, Axis::C});
  facts.machine.axes.resize(axes);
  screen.window.show_connected(facts);
  screen.window.show_status(ready());
  screen.button("user_keys").setChecked(GENERATE(false, true));
  screen.window.resize(1024, 768);
  CHECK(wait_until([&] { return screen.window.size() == QSize(1024, 768); }));
  CHECK(screen.window.minimumSizeHint().width() <= 1024);
  CHECK(screen.window.minimumSizeHint().height() <= 768);
  constexpr int kSmallestTarget = 40;  // px: 12 mm on a 15 inch screen (0.297 mm each)
  for (const QPushButton* const button : screen.window.findChildren<QPushButton*>()) {
    if (!button->isVisible()) continue;
    CAPTURE(button->objectName().toStdString(), button->size().width(), button->size().height());
    CHECK(button->height() >= kSmallestTarget);
    CHECK(button->width() >= kSmallestTarget);
    CHECK(screen.window.rect().contains(
        QRect(button->mapTo(&screen.window, QPoint(0, 0)), button->size())));
  }
}

}  // namespace cnc::gui::test
