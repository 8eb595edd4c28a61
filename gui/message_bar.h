// What the machine has to say. One line shows the newest message; an error stays there until it has
// been acknowledged, with the number of messages that came meanwhile. The list opens below the
// line, over the page, so that Reset and Esc keep working.
#pragma once

#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QWidget>
#include <optional>

#include "api/message.h"

namespace cnc::gui {

class MessageBar : public QWidget {
  Q_OBJECT

 public:
  static constexpr int kMostMessages = 1000;  ///< as many as the server keeps

  explicit MessageBar(QWidget* parent = nullptr);

  void add(const api::Message& message);
  /// A refusal or another error that only this screen knows of.
  void add_error(const QString& what, const api::Error& error);

 private:
  void acknowledge();
  void toggle_list();
  void show_newest(const api::Message& message);

  QLabel* mark_;
  QLabel* line_;
  QPushButton* acknowledge_;
  QPushButton* toggle_;
  QListWidget* list_;
  int unacknowledged_ = 0;
  std::optional<api::Severity> shown_;
};

}  // namespace cnc::gui
