// A program's question on the screen, the probe lamp, and the user keys.
#include <QImage>
#include <QTemporaryDir>
#include <catch2/catch.hpp>

#include "gui/main_window.h"
#include "gui/style.h"
#include "tests/gui/support.h"

namespace cnc::gui::test {
namespace {

using api::Axis;
using api::Command;
using api::MachineState;

api::Question question_with(std::uint64_t number, int fields) {
  api::Question question{number, "Measure tool", {}};
  for (int index = 0; index < fields; ++index)
    question.fields.push_back({"Value " + std::to_string(index), 100 + index, 0.5 + index});
  return question;
}

api::MachineStatus asking(const api::Question& question) {
  auto status = status_with(MachineState::question, {Command::answer, Command::stop, Command::jog});
  status.question = question;
  return status;
}

struct Screen {
  QApplication& app = application();
  MainWindow window{QStringLiteral("unix:///run/cnc.sock"), true};
  QuestionDialog& dialog = child<QuestionDialog>(window, "question");
  std::vector<Request> requests;

  Screen() {
    QObject::connect(&window, &MainWindow::requested, &window,
                     [this](const Request& request) { requests.push_back(request); });
    window.resize(1024, 768);
    show_active(window);
    connect({});
  }

  void connect(const std::string& picture_folder) {
    MachineFacts facts = facts_with({Axis::X, Axis::Y, Axis::Z});
    facts.machine.picture_folder = picture_folder;
    window.show_connected(facts);
  }
  [[nodiscard]] QPushButton& button(const char* name) { return child<QPushButton>(window, name); }
  [[nodiscard]] QLineEdit& value(int index) {
    return child<QLineEdit>(window, ("question_value_" + std::to_string(index)).c_str());
  }
  /// As the keyboard does it.
  static void type(QLineEdit& editor, const QString& text) {
    editor.selectAll();
    editor.insert(text);
    editor.setModified(true);
  }
};

}  // namespace

TEST_CASE("A question opens with title, labels and proposed values; OK answers it",
          "[gui][LNG-4]") {
  Screen screen;
  CHECK_FALSE(screen.dialog.isVisible());
  screen.window.show_status(asking(question_with(7, 2)));
  CHECK(screen.dialog.isVisible());
  CHECK(child<QLabel>(screen.dialog, "question_title").text() == "Measure tool");
  CHECK(screen.value(0).text() == "0.5");
  CHECK(screen.value(0).hasFocus());
  Screen::type(screen.value(1), "−12,25");
  screen.button("question_ok").click();
  const auto answers = only<Answer>(screen.requests);
  REQUIRE(answers.size() == 1);
  CHECK(answers.front().question == 7);
  CHECK(answers.front().confirmed);
  CHECK(answers.front().values == std::vector{0.5, -12.25});
}

TEST_CASE("A value that nobody touches is answered to its last digit", "[gui][LNG-4]") {
  Screen screen;
  constexpr double kThird = 1.0 / 3.0;
  api::Question question = question_with(7, 1);
  question.fields[0].value = kThird;
  screen.window.show_status(asking(question));
  screen.button("question_ok").click();
  CHECK(only<Answer>(screen.requests).at(0).values == std::vector{kThird});
}

TEST_CASE("Cancel answers without values", "[gui][LNG-4]") {
  Screen screen;
  screen.window.show_status(asking(question_with(7, 2)));
  screen.button("question_cancel").click();
  const auto answers = only<Answer>(screen.requests);
  REQUIRE(answers.size() == 1);
  CHECK_FALSE(answers.front().confirmed);
  CHECK(answers.front().values.empty());
}

TEST_CASE("What is not a number is not sent, and the screen says which", "[gui][LNG-4]") {
  Screen screen;
  screen.window.show_status(asking(question_with(7, 2)));
  const auto text = GENERATE("deep", "", "1.2.3", "inf", "nan");
  Screen::type(screen.value(1), text);
  screen.button("question_ok").click();
  CHECK(screen.requests.empty());
  CHECK(screen.value(1).hasFocus());
  CHECK(child<QLabel>(screen.dialog, "question_note").isVisible());
  CHECK(child<QLabel>(screen.dialog, "question_note").text().contains(text));
}

TEST_CASE("Neither Enter nor Esc answers; Ctrl+Enter is OK", "[gui][LNG-4][safety]") {
  Screen screen;
  screen.window.show_status(asking(question_with(7, 2)));
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Return);
  CHECK(screen.value(1).hasFocus());
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Return);
  CHECK(screen.value(0).hasFocus());  // round and round
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Escape);
  CHECK(only<Answer>(screen.requests).empty());
  CHECK(screen.dialog.isVisible());
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Return, Qt::ControlModifier);
  CHECK(only<Answer>(screen.requests).size() == 1);
}

TEST_CASE("A question without fields takes OK or Cancel, and keys still jog", "[gui][LNG-4]") {
  Screen screen;
  screen.window.show_status(asking(question_with(7, 0)));
  CHECK(screen.dialog.isVisible());
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Return);
  CHECK(screen.requests.empty());
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Right);
  CHECK(screen.window.jog_lease().is_holding());
  screen.window.jog_lease().release_all();
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Enter, Qt::ControlModifier);
  CHECK(only<Answer>(screen.requests).size() == 1);
}

TEST_CASE("The question goes when it is answered elsewhere or the program is stopped",
          "[gui][LNG-4]") {
  Screen screen;
  screen.window.show_status(asking(question_with(7, 1)));
  screen.window.show_status(status_with(MachineState::running, {Command::pause}));
  CHECK_FALSE(screen.dialog.isVisible());
  CHECK(screen.window.hasFocus());  // the arrow keys jog again
  screen.window.show_status(asking(question_with(8, 3)));
  CHECK(screen.dialog.isVisible());
  CHECK(screen.value(2).text() == "2.5");
}

TEST_CASE("What has been typed stays while the question stands", "[gui][LNG-4]") {
  Screen screen;
  screen.window.show_status(asking(question_with(7, 1)));
  Screen::type(screen.value(0), "42");
  auto jogging = status_with(MachineState::jogging, {Command::stop});
  jogging.question = question_with(7, 1);
  screen.window.show_status(jogging);
  CHECK_FALSE(screen.button("question_ok").isEnabled());
  CHECK(screen.button("question_ok").toolTip() == kRefusal);
  screen.window.show_disconnected("gone");
  CHECK_FALSE(screen.value(0).isEnabled());
  screen.window.show_status(asking(question_with(7, 1)));
  CHECK(screen.value(0).text() == "42");
  CHECK(screen.value(0).isEnabled());
  CHECK(screen.button("question_ok").isEnabled());
}

TEST_CASE("An answer is sent once; after a refusal it can be sent again", "[gui][LNG-4]") {
  Screen screen;
  screen.window.show_status(asking(question_with(7, 1)));
  screen.button("question_ok").click();
  screen.window.show_status(asking(question_with(7, 1)));  // from before the answer arrived
  screen.button("question_ok").click();
  send_key(screen.window, QEvent::KeyPress, Qt::Key_Return, Qt::ControlModifier);
  REQUIRE(only<Answer>(screen.requests).size() == 1);
  api::Error error;
  error.kind = api::ErrorKind::refused;
  error.message = "not now";
  screen.window.show_refusal(screen.requests.at(0), error);
  screen.window.show_status(asking(question_with(7, 1)));
  screen.button("question_ok").click();
  CHECK(only<Answer>(screen.requests).size() == 2);
}

TEST_CASE("A new screen shows the question that stands", "[gui][LNG-4]") {
  { Screen{}.window.show_status(asking(question_with(7, 1))); }
  Screen again;
  again.window.show_status(asking(question_with(7, 1)));
  CHECK(again.dialog.isVisible());
}

TEST_CASE("Up to twenty long fields fit, and Stop and the read-outs stay free",
          "[gui][LNG-4][GUI-10]") {
  const auto fields = GENERATE(0, 1, 6, 7, 12, 20);
  CAPTURE(fields);
  set_up_look(application());
  Screen screen;
  api::Question question = question_with(7, fields);
  question.title = "Place the probe plate on the work piece and say how high it is above the table";
  for (auto& field : question.fields) field.label += " of the tool in the spindle";
  screen.window.show_status(asking(question));
  screen.window.show_status(asking(question));  // behind the layout of the first
  const QRect dialog = screen.dialog.geometry();
  CHECK(screen.window.rect().contains(dialog));
  for (const char* const name : {"stop", "reset", "home_X", "Feed_more"}) {
    QPushButton& button = screen.button(name);
    CHECK_FALSE(
        dialog.intersects(QRect(button.mapTo(&screen.window, QPoint(0, 0)), button.size())));
  }
  for (const char* const name : {"question_ok", "question_cancel"}) {
    QPushButton& button = screen.button(name);
    CHECK(dialog.contains(QRect(button.mapTo(&screen.window, QPoint(0, 0)), button.size())));
  }
}

TEST_CASE("The picture that the title names is shown, and no other file", "[gui][LNG-4]") {
  const QTemporaryDir folder;
  QImage image(600, 300, QImage::Format_RGB32);
  image.fill(Qt::blue);
  REQUIRE(image.save(folder.filePath("plate.png")));
  REQUIRE(QDir(folder.path()).mkdir("pictures"));
  REQUIRE(image.save(folder.filePath("pictures/plate.png")));
  Screen screen;
  screen.connect(folder.filePath("pictures").toStdString());
  const auto shows = [&](const std::string& title) {
    api::Question question = question_with(7, 1);
    question.title = title;
    screen.window.show_status(asking(question));
    return screen.dialog.findChild<QLabel*>("question_picture") != nullptr;
  };
  CHECK(shows("plate"));
  CHECK_FALSE(shows("../plate"));
  CHECK_FALSE(shows("other"));
  CHECK_FALSE(shows(""));
}

TEST_CASE("A user key runs the sub of its name, when single lines are possible", "[gui][LNG-6]") {
  Screen screen;
  CHECK_FALSE(screen.button("user_1").isVisible());
  screen.button("user_keys").click();
  for (const int number : {1, 10}) {
    const std::string name = "user_" + std::to_string(number);
    QPushButton& key = screen.button(name.c_str());
    CAPTURE(name);
    screen.window.show_status(status_with(MachineState::needs_homing, {}));
    CHECK(key.isVisible());
    CHECK_FALSE(key.isEnabled());
    CHECK(key.toolTip() == kRefusal);
    screen.requests.clear();
    screen.window.show_status(status_with(MachineState::ready, {Command::mdi}));
    key.click();
    REQUIRE(only<RunSub>(screen.requests).size() == 1);
    CHECK(only<RunSub>(screen.requests).front().name == name);
  }
}

TEST_CASE("The lamp of the probe", "[gui][GCO-8]") {
  Screen screen;
  auto status = status_with(MachineState::ready, {});
  screen.window.show_status(status);
  CHECK(child<QLabel>(screen.window, "probe").text().toStdString() == "○ probe");
  status.probe_input = true;
  screen.window.show_status(status);
  CHECK(child<QLabel>(screen.window, "probe").text().toStdString() == "● probe touches");
}

}  // namespace cnc::gui::test
