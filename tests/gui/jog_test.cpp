// The dead-man's part of jogging: what starts it, what keeps it, and everything that ends it.
#include <QDialog>
#include <QLineEdit>
#include <catch2/catch.hpp>

#include "gui/jog_button.h"
#include "gui/jog_keys.h"
#include "gui/jog_lease.h"
#include "gui/jog_panel.h"
#include "tests/gui/support.h"

namespace cnc::gui::test {
namespace {

using api::Axis;
using Clock = std::chrono::steady_clock;

// A window with a text editor, jogged by the keyboard, and what reached the machine.
struct Screen {
  QApplication& app = application();
  Clock::time_point now = Clock::now();
  QWidget window;
  QLineEdit editor{&window};
  JogLease lease{nullptr, [this] { return now; }};
  JogKeys keys{window, lease};
  std::vector<api::JogVelocities> renewals;
  int ends = 0;

  Screen() {
    QObject::connect(&lease, &JogLease::renewed, &window,
                     [this](const api::JogVelocities& wanted) { renewals.push_back(wanted); });
    QObject::connect(&lease, &JogLease::ended, &window, [this] { ++ends; });
    lease.set_allowed(true);
    window.setFocusPolicy(Qt::ClickFocus);
    show_active(window);
  }

  void press(int key, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
    send_key(window, QEvent::KeyPress, key, modifiers);
  }
  void release(int key, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
    send_key(window, QEvent::KeyRelease, key, modifiers);
  }
  [[nodiscard]] api::JogVelocity last() const {
    REQUIRE(!renewals.empty());
    REQUIRE(renewals.back().size() == 1);
    return renewals.back().front();
  }
};

}  // namespace

TEST_CASE("Arrows and page keys jog X, Y and Z in the direction they point", "[gui][MAN-1]") {
  struct Row {
    int key;
    Axis axis;
    double direction;
  };
  const auto row =
      GENERATE(Row{Qt::Key_Left, Axis::X, -1.0}, Row{Qt::Key_Right, Axis::X, 1.0},
               Row{Qt::Key_Down, Axis::Y, -1.0}, Row{Qt::Key_Up, Axis::Y, 1.0},
               Row{Qt::Key_PageDown, Axis::Z, -1.0}, Row{Qt::Key_PageUp, Axis::Z, 1.0});
  Screen screen;
  screen.press(row.key);
  CHECK(screen.last().axis == row.axis);
  CHECK(screen.last().rate == Approx(0.1 * row.direction));
}

TEST_CASE("A jog key moves at 10 %, with Ctrl at 50 %, with Shift at 100 %", "[gui][MAN-1]") {
  Screen screen;
  screen.press(Qt::Key_Right, Qt::ControlModifier);
  CHECK(screen.last().rate == Approx(0.5));
  screen.release(Qt::Key_Right, Qt::ControlModifier);
  screen.press(Qt::Key_Right, Qt::ShiftModifier);
  CHECK(screen.last().rate == Approx(1.0));
}

TEST_CASE("A held key is renewed again and again, until it is released", "[gui][MAN-1]") {
  Screen screen;
  screen.press(Qt::Key_Right);
  REQUIRE(wait_until([&] { return screen.renewals.size() >= 4; }));
  CHECK(screen.ends == 0);

  screen.release(Qt::Key_Right);
  CHECK(screen.ends == 1);
  const std::size_t renewals = screen.renewals.size();
  CHECK_FALSE(
      wait_until([&] { return screen.renewals.size() > renewals; }, 4 * JogLease::kRenewal));
}

TEST_CASE("Auto-repeat neither starts nor ends a jog", "[gui][MAN-1]") {
  Screen screen;
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Right, Qt::NoModifier, true);
  CHECK(screen.renewals.empty());

  screen.press(Qt::Key_Right);
  send_key(screen.window, QEvent::KeyRelease, Qt::Key_Right, Qt::NoModifier, true);
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Right, Qt::NoModifier, true);
  CHECK(screen.ends == 0);
  CHECK(screen.renewals.size() == 1);
}

TEST_CASE("A key pressed with Shift is released without it as well", "[gui][MAN-1]") {
  Screen screen;
  screen.press(Qt::Key_Right, Qt::ShiftModifier);
  screen.release(Qt::Key_Right);
  CHECK(screen.ends == 1);
}

TEST_CASE("A modifier that changes under a held key slows down and never speeds up",
          "[gui][MAN-1]") {
  Screen screen;
  screen.press(Qt::Key_Left, Qt::ShiftModifier);
  // As the display server sends it: the event of a modifier key carries the modifiers before it.
  screen.release(Qt::Key_Shift, Qt::ShiftModifier);
  CHECK(screen.last().rate == Approx(-0.1));
  screen.press(Qt::Key_Shift, Qt::NoModifier);
  screen.release(Qt::Key_Control, Qt::ShiftModifier | Qt::ControlModifier);
  CHECK(screen.last().rate == Approx(-0.1));
}

TEST_CASE("Two keys move two axes; opposite keys cancel each other", "[gui][MAN-1]") {
  Screen screen;
  screen.press(Qt::Key_Right);
  screen.press(Qt::Key_Up);
  CHECK(screen.renewals.back().size() == 2);
  screen.press(Qt::Key_Left);
  CHECK(screen.last().axis == Axis::Y);
  screen.release(Qt::Key_Up);
  CHECK(screen.renewals.back().empty());
  CHECK(screen.ends == 0);
}

TEST_CASE("Each of these ends a jog although the key is still down", "[gui][MAN-1]") {
  Screen screen;
  screen.press(Qt::Key_Right);
  REQUIRE(screen.lease.is_holding());

  SECTION("the focus goes to a text editor") { screen.editor.setFocus(); }
  SECTION("the window is deactivated") {
    QEvent event(QEvent::WindowDeactivate);
    QCoreApplication::sendEvent(&screen.window, &event);
  }
  SECTION("a modal dialog opens") {
    QDialog dialog(&screen.window);
    dialog.open();
    CHECK(wait_until([&] { return !screen.lease.is_holding(); }));
  }
  SECTION("the application is no longer the active one") {
    emit qApp->applicationStateChanged(Qt::ApplicationInactive);
  }
  SECTION("the window is hidden") { screen.window.hide(); }
  SECTION("the machine does not allow it any more") { screen.lease.set_allowed(false); }
  CHECK_FALSE(screen.lease.is_holding());
  CHECK(screen.ends == 1);
}

TEST_CASE("In a text editor the arrow keys move the cursor, not the machine", "[gui][MAN-1]") {
  Screen screen;
  screen.editor.setFocus();
  screen.press(Qt::Key_Up);
  screen.press(Qt::Key_Left);
  CHECK(screen.renewals.empty());
}

TEST_CASE("A key that went down while jogging was refused does nothing later", "[gui][MAN-1]") {
  Screen screen;
  screen.lease.set_allowed(false);
  screen.press(Qt::Key_Right);
  screen.lease.set_allowed(true);
  CHECK_FALSE(screen.lease.is_holding());
  CHECK(screen.renewals.empty());
}

TEST_CASE("A screen that hung longer than the lease does not go on by itself", "[gui][MAN-1]") {
  Screen screen;
  screen.press(Qt::Key_Right);
  screen.now += JogLease::kLease + std::chrono::milliseconds(1);
  REQUIRE(wait_until([&] { return screen.ends == 1; }));
  CHECK(screen.renewals.size() == 1);
}

TEST_CASE("A jog button moves while it is held and stops when it is left", "[gui][MAN-1]") {
  application();
  JogButton button(QStringLiteral("X+"));
  button.resize(80, 60);
  button.show();
  int held = 0;
  int let_go = 0;
  QObject::connect(&button, &JogButton::held, &button, [&] { ++held; });
  QObject::connect(&button, &JogButton::let_go, &button, [&] { ++let_go; });

  send_mouse(button, QEvent::MouseButtonPress, {10, 10});
  REQUIRE(held == 1);
  SECTION("released") { send_mouse(button, QEvent::MouseButtonRelease, {10, 10}); }
  SECTION("left, and it does not start again on the way back") {
    send_mouse(button, QEvent::MouseMove, {-5, 10});
    send_mouse(button, QEvent::MouseMove, {10, 10});
  }
  SECTION("disabled") { button.setEnabled(false); }
  SECTION("hidden") { button.hide(); }
  CHECK(held == 1);
  CHECK(let_go == 1);
}

TEST_CASE("A touch that the system takes away is a release", "[gui][MAN-1][GUI-10]") {
  application();
  JogButton button(QStringLiteral("X+"));
  int let_go = 0;
  QObject::connect(&button, &JogButton::let_go, &button, [&] { ++let_go; });
  QTouchEvent begin(QEvent::TouchBegin);
  QCoreApplication::sendEvent(&button, &begin);
  CHECK(button.isDown());
  QTouchEvent cancel(QEvent::TouchCancel);
  QCoreApplication::sendEvent(&button, &cancel);
  CHECK_FALSE(button.isDown());
  CHECK(let_go == 1);
}

TEST_CASE("In step mode one tap is one step, however long it is held", "[gui][MAN-2]") {
  application();
  JogLease lease;
  lease.set_allowed(true);
  JogPanel panel(lease);
  panel.show_axes({Axis::X, Axis::Y, Axis::Z});
  panel.show_status(status_with(api::MachineState::ready, {api::Command::jog}));
  std::vector<Request> requests;
  QObject::connect(&panel, &JogPanel::requested, &panel,
                   [&](const Request& request) { requests.push_back(request); });

  child<QPushButton>(panel, "mode_0.1").click();
  auto& minus = child<JogButton>(panel, "Z_minus");
  send_mouse(minus, QEvent::MouseButtonPress, {10, 10});
  CHECK_FALSE(lease.is_holding());
  send_mouse(minus, QEvent::MouseButtonRelease, {10, 10});
  REQUIRE(requests.size() == 1);
  const auto step = std::get<JogStep>(requests.front());
  CHECK(step.axis == Axis::Z);
  CHECK(step.distance == Approx(-0.1));
}

}  // namespace cnc::gui::test
