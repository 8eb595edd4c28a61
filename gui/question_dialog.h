// What a program asks (dlgmsg): its title, a picture of that name if there is one, an editor for
// each value, OK and Cancel.
//
// It lies over the program list, inside the window: it cannot get behind it, and read-outs, Stop
// and the jog keys stay within reach. Only its keys answer. Enter goes to the next value, and Esc
// does what it does everywhere, so that neither makes the machine move on; Ctrl+Enter is OK.
#pragma once

#include <QFrame>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QScrollArea>
#include <optional>
#include <vector>

#include "gui/command_button.h"
#include "gui/request.h"

namespace cnc::gui {

class QuestionDialog : public QFrame {
  Q_OBJECT

 public:
  explicit QuestionDialog(QWidget* parent = nullptr);

  /// Where the pictures are; they need not exist on this computer.
  void set_picture_folder(const QString& folder) { picture_folder_ = folder; }
  /// The largest place that it may take, in its parent's coordinates.
  void set_area(const QRect& area);
  /// Opens, closes and greys itself. What has been typed stays for as long as the question stands.
  void show_status(const api::MachineStatus& status);
  void show_disconnected();
  /// The answer was refused: the keys can be used again.
  void show_refused() { is_sent_ = false; }

 signals:
  void requested(const cnc::gui::Request& request);

 protected:
  void keyPressEvent(QKeyEvent* event) override;

 private:
  void open(const api::Question& question);
  void end();
  void add_picture(const std::string& title);
  void add_fields();
  QLineEdit* make_editor(std::size_t index);
  void go_to(std::size_t index);
  void place();
  void confirm();
  void answer(bool confirmed, std::vector<double> values);
  [[nodiscard]] std::optional<double> value_of(std::size_t index);

  std::optional<api::Question> question_;
  bool is_sent_ = false;  // and not refused
  QString picture_folder_;
  QRect area_;
  QLabel* title_;
  QScrollArea* scroll_;
  QLabel* note_;
  CommandButton* ok_;
  CommandButton* cancel_;
  QWidget* body_ = nullptr;  // made anew for each question
  std::vector<QLineEdit*> editors_;
};

}  // namespace cnc::gui
