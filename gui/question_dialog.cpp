#include "gui/question_dialog.h"

#include <QFileInfo>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QPixmap>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "gui/style.h"
#include "gui/text.h"

namespace cnc::gui {
namespace {

constexpr int kMargin = 12;
constexpr int kKeyHeight = 56;
constexpr int kEditorHeight = 40;
constexpr int kEditorWidth = 112;
constexpr int kGapOfColumns = 20;
constexpr int kMostInOneColumn = 6;
constexpr QSize kMostOfPicture(480, 220);

/// What the layout needs at this width; texts wrap.
int height_for(const QLayout& layout, int width) {
  return layout.hasHeightForWidth() ? layout.heightForWidth(width) : layout.sizeHint().height();
}

/// The picture that a title names; none if the title is no plain file name.
QPixmap picture_of(const QString& folder, const QString& title) {
  const bool is_plain = !title.isEmpty() && QFileInfo(title).fileName() == title;
  if (folder.isEmpty() || !is_plain) return {};
  const QPixmap picture(folder + u'/' + title + QStringLiteral(".png"));
  const bool fits =
      picture.width() <= kMostOfPicture.width() && picture.height() <= kMostOfPicture.height();
  if (picture.isNull() || fits) return picture;
  return picture.scaled(kMostOfPicture, Qt::KeepAspectRatio, Qt::SmoothTransformation);
}

QLabel* make_wrapping_label(const QString& text, QWidget* parent) {
  auto* const label = new QLabel(text, parent);
  label->setTextFormat(Qt::PlainText);
  label->setWordWrap(true);
  return label;
}

}  // namespace

QuestionDialog::QuestionDialog(QWidget* parent)
    : QFrame(parent),
      title_(make_wrapping_label({}, this)),
      scroll_(new QScrollArea(this)),
      note_(make_wrapping_label({}, this)),
      ok_(new CommandButton(tr("OK\nCtrl+Enter"), this)),
      cancel_(new CommandButton(tr("Cancel"), this)) {
  setObjectName(QStringLiteral("question"));
  setFocusPolicy(Qt::ClickFocus);
  title_->setObjectName(QStringLiteral("question_title"));
  note_->setObjectName(QStringLiteral("question_note"));
  ok_->setObjectName(QStringLiteral("question_ok"));
  cancel_->setObjectName(QStringLiteral("question_cancel"));
  note_->setProperty("tone", "yellow");
  scroll_->setWidgetResizable(true);
  scroll_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scroll_->setFocusPolicy(Qt::NoFocus);

  auto* const keys = new QHBoxLayout;
  keys->setSpacing(kMargin);
  for (CommandButton* const button : {ok_, cancel_}) {
    button->setFixedHeight(kKeyHeight);
    keys->addWidget(button);
  }
  ok_->set_awaited(true);
  auto* const column = new QVBoxLayout(this);
  column->setContentsMargins(kMargin, kMargin, kMargin, kMargin);
  column->setSpacing(kMargin);
  column->addWidget(title_);
  column->addWidget(scroll_, 1);
  column->addWidget(note_);
  column->addLayout(keys);
  connect(ok_, &QPushButton::clicked, this, &QuestionDialog::confirm);
  connect(cancel_, &QPushButton::clicked, this, [this] { answer(false, {}); });
  hide();
}

void QuestionDialog::show_status(const api::MachineStatus& status) {
  setEnabled(true);
  if (status.question != question_) status.question ? open(*status.question) : end();
  if (!question_) return;
  const api::CommandAvailability under_way{
      false, tr("The answer is on its way to the machine.").toStdString()};
  for (CommandButton* const button : {ok_, cancel_}) {
    button->show_availability(is_sent_ ? under_way : status.availability(api::Command::answer));
  }
}

void QuestionDialog::show_disconnected() {
  is_sent_ = false;
  setEnabled(false);
}

void QuestionDialog::open(const api::Question& question) {
  question_ = question;
  is_sent_ = false;
  editors_.clear();
  delete body_;
  body_ = new QWidget(scroll_);
  auto* const column = new QVBoxLayout(body_);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(kMargin);
  title_->setText(to_text(question.title));
  note_->hide();
  add_picture(question.title);
  add_fields();
  scroll_->setWidget(body_);
  scroll_->setVisible(column->count() > 0);
  place();
  show();
  raise();
  if (editors_.empty()) return setFocus();
  go_to(0);
}

void QuestionDialog::end() {
  question_.reset();
  hide();
  parentWidget()->setFocus();  // the arrow keys are for jogging again
}

void QuestionDialog::add_picture(const std::string& title) {
  const QPixmap picture = picture_of(picture_folder_, to_text(title));
  if (picture.isNull()) return;
  auto* const label = new QLabel(body_);
  label->setPixmap(picture);
  label->setAlignment(Qt::AlignCenter);
  label->setObjectName(QStringLiteral("question_picture"));
  body_->layout()->addWidget(label);
}

void QuestionDialog::add_fields() {
  const auto count = static_cast<int>(question_->fields.size());
  if (count == 0) return;
  const int columns = count > kMostInOneColumn ? 2 : 1;
  const int rows = (count + columns - 1) / columns;
  auto* const grid = new QGridLayout;
  grid->setVerticalSpacing(4);
  for (int index = 0; index < count; ++index) {
    const int column = 3 * (index / rows);  // label, editor, gap
    const auto place = static_cast<std::size_t>(index);
    const QString label = to_text(question_->fields[place].label);
    grid->addWidget(make_wrapping_label(label, body_), index % rows, column);
    grid->addWidget(make_editor(place), index % rows, column + 1);
    grid->setColumnStretch(column, 1);
  }
  if (columns == 2) grid->setColumnMinimumWidth(2, kGapOfColumns);
  static_cast<QVBoxLayout*>(body_->layout())->addLayout(grid);
}

QLineEdit* QuestionDialog::make_editor(std::size_t index) {
  auto* const editor = new QLineEdit(value_text(question_->fields[index].value), body_);
  editor->setFixedSize(kEditorWidth, kEditorHeight);
  editor->setAlignment(Qt::AlignRight);
  editor->setInputMethodHints(Qt::ImhFormattedNumbersOnly);
  editor->setObjectName(QStringLiteral("question_value_%1").arg(index));
  connect(editor, &QLineEdit::returnPressed, this, [this, index] { go_to(index + 1); });
  connect(editor, &QLineEdit::textEdited, this, [editor] { set_look(*editor, "tone", {}); });
  editors_.push_back(editor);
  return editor;
}

/// Round and round.
void QuestionDialog::go_to(std::size_t index) {
  QLineEdit& editor = *editors_.at(index % editors_.size());
  editor.setFocus();
  editor.selectAll();
  scroll_->ensureWidgetVisible(&editor);
}

void QuestionDialog::set_area(const QRect& area) {
  if (area == area_) return;
  area_ = area;
  if (question_) place();
}

/// As high as its contents need, from the top of its area; what does not fit is scrolled to.
void QuestionDialog::place() {
  const int width = area_.width() - 2 * kMargin;
  scroll_->setFixedHeight(height_for(*body_->layout(), width));
  const int wanted = height_for(*layout(), area_.width());
  const int excess = std::max(0, wanted - area_.height());
  scroll_->setFixedHeight(std::max(0, scroll_->height() - excess));
  setGeometry(QRect(area_.topLeft(), QSize(area_.width(), wanted - excess)));
}

void QuestionDialog::keyPressEvent(QKeyEvent* event) {
  const bool is_enter = event->key() == Qt::Key_Return || event->key() == Qt::Key_Enter;
  if (is_enter && event->modifiers().testFlag(Qt::ControlModifier)) return confirm();
  QFrame::keyPressEvent(event);
}

/// A value that nobody touched is sent as it was proposed, to its last digit.
std::optional<double> QuestionDialog::value_of(std::size_t index) {
  const QLineEdit& editor = *editors_[index];
  return editor.isModified() ? number_of(editor.text()) : question_->fields[index].value;
}

void QuestionDialog::confirm() {
  if (!question_ || !ok_->isEnabled()) return;
  std::vector<double> values;
  for (std::size_t index = 0; index < editors_.size(); ++index) {
    const auto value = value_of(index);
    if (!value) {
      note_->setText(tr("“%1” is not a number: write it like 12.5.").arg(editors_[index]->text()));
      note_->show();
      set_look(*editors_[index], "tone", QStringLiteral("yellow"));
      place();
      return go_to(index);
    }
    values.push_back(*value);
  }
  answer(true, std::move(values));
}

void QuestionDialog::answer(bool confirmed, std::vector<double> values) {
  is_sent_ = true;
  ok_->setEnabled(false);
  cancel_->setEnabled(false);
  emit requested(Answer{question_->number, confirmed, std::move(values)});
}

}  // namespace cnc::gui
