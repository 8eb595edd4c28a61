// cncgui: the operator's screen of a machine whose server runs here or elsewhere.
#include <QApplication>
#include <QCommandLineParser>
#include <QFileInfo>
#include <QScreen>

#include "gui/connection.h"
#include "gui/main_window.h"
#include "gui/style.h"

namespace {

using namespace cnc::gui;

struct Options {
  std::string server;
  QString file;
};

Options parse_command_line(const QApplication& application) {
  QCommandLineParser parser;
  parser.setApplicationDescription("The operator's screen of a CNC machine.");
  parser.addHelpOption();
  parser.addVersionOption();
  const QCommandLineOption server(
      "server",
      "Where the server listens: unix:///path/of/socket or host:port. Default: the environment "
      "variable CNC_SERVER, else the socket that the server opens for this user.",
      "address", QString::fromStdString(cnc::api::default_address()));
  parser.addOption(server);
  parser.addPositionalArgument("file", "Program to load, a path of the server's computer.",
                               "[file]");
  parser.process(application);
  return {parser.value(server).toStdString(), parser.positionalArguments().value(0)};
}

void connect_both_ways(Connection& connection, MainWindow& window) {
  QObject::connect(&connection, &Connection::connected, &window, &MainWindow::show_connected);
  QObject::connect(&connection, &Connection::disconnected, &window, &MainWindow::show_disconnected);
  QObject::connect(&connection, &Connection::status_arrived, &window, &MainWindow::show_status);
  QObject::connect(&connection, &Connection::message_arrived, &window, &MainWindow::show_message);
  QObject::connect(&connection, &Connection::refused, &window, &MainWindow::show_refusal);
  QObject::connect(&connection, &Connection::jog_refused, &window, &MainWindow::show_jog_refusal);
  QObject::connect(&window, &MainWindow::requested, &connection, &Connection::execute);

  QObject::connect(&window.jog_lease(), &JogLease::renewed, &connection, &Connection::jog);
  QObject::connect(&window.jog_lease(), &JogLease::ended, &connection, &Connection::end_jog);

  ProgramPanel& program = window.program();
  QObject::connect(&connection, &Connection::loaded, &program, &ProgramPanel::show_loaded);
  QObject::connect(&connection, &Connection::problems_arrived, &program,
                   &ProgramPanel::show_problems);
  QObject::connect(&program, &ProgramPanel::problems_wanted, &connection,
                   &Connection::fetch_problems);
  ProgramModel& model = program.model();
  QObject::connect(&connection, &Connection::page_arrived, &model, &ProgramModel::take_page);
  QObject::connect(&connection, &Connection::page_failed, &model, &ProgramModel::drop_page);
  QObject::connect(&model, &ProgramModel::page_wanted, &connection, &Connection::fetch_page);
}

// On a screen of the smallest size a window frame would leave too little room.
void show_window(QWidget& window) {
  constexpr QSize kSmallestScreen(1024, 768);
  window.resize(kSmallestScreen);
  const QSize screen = window.screen()->size();
  if (screen.width() <= kSmallestScreen.width() || screen.height() <= kSmallestScreen.height()) {
    window.showFullScreen();
  } else {
    window.show();
  }
}

}  // namespace

int main(int argc, char* argv[]) {
  QApplication application(argc, argv);
  QApplication::setApplicationName("cncgui");
  QApplication::setApplicationVersion(CNC_VERSION);
  const Options options = parse_command_line(application);
  set_up_look(application);

  Connection connection(options.server);
  MainWindow window(connection.address(), connection.is_local());
  connect_both_ways(connection, window);
  if (!options.file.isEmpty()) {
    const QString path =
        connection.is_local() ? QFileInfo(options.file).absoluteFilePath() : options.file;
    window.load_when_ready(path.toStdString());
  }
  show_window(window);
  connection.start();
  return QApplication::exec();
}
