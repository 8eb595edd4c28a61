#include "gui/style.h"

#include <QFile>
#include <QPalette>
#include <QStyle>
#include <QVariant>
#include <array>

// Resources of a static library are linked only where somebody asks for them; the macro works only
// outside of a namespace.
static void open_resources() { Q_INIT_RESOURCE(gui); }

namespace cnc::gui {
namespace {

struct Token {
  const char* name;
  QRgb rgb;
};

// No name is the beginning of another, so the order does not matter.
constexpr std::array kTokens{
    Token{"@ground", colour::kGround},      Token{"@panel", colour::kPanel},
    Token{"@pressed", colour::kKeyPressed}, Token{"@key", colour::kKey},
    Token{"@edge", colour::kEdge},          Token{"@text", colour::kText},
    Token{"@dim", colour::kDimText},        Token{"@off", colour::kOffText},
    Token{"@grey", colour::kGrey},          Token{"@yellow", colour::kYellow},
    Token{"@green", colour::kGreen},        Token{"@red", colour::kRed},
    Token{"@blue", colour::kBlue},
};

/// style.qss with the colours put in.
QString style_sheet() {
  open_resources();
  QFile file(QStringLiteral(":/style.qss"));
  if (!file.open(QIODevice::ReadOnly)) return {};
  QString sheet = QString::fromUtf8(file.readAll());
  for (const Token& token : kTokens) {
    sheet.replace(QLatin1String(token.name), QColor::fromRgb(token.rgb).name());
  }
  return sheet;
}

QPalette dark_palette() {
  QPalette palette;
  palette.setColor(QPalette::Window, QColor::fromRgb(colour::kGround));
  palette.setColor(QPalette::Base, QColor::fromRgb(colour::kPanel));
  palette.setColor(QPalette::AlternateBase, QColor::fromRgb(colour::kGround));
  palette.setColor(QPalette::Button, QColor::fromRgb(colour::kKey));
  palette.setColor(QPalette::Highlight, QColor::fromRgb(colour::kBlue));
  for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText,
                          QPalette::HighlightedText, QPalette::ToolTipText}) {
    palette.setColor(role, QColor::fromRgb(colour::kText));
  }
  palette.setColor(QPalette::PlaceholderText, QColor::fromRgb(colour::kOffText));
  return palette;
}

}  // namespace

void set_up_look(QApplication& application) {
  QApplication::setStyle(QStringLiteral("Fusion"));  // the same on every desktop
  QApplication::setPalette(dark_palette());
  application.setStyleSheet(style_sheet());
}

void set_look(QWidget& widget, const char* name, const QString& value) {
  if (widget.property(name).toString() == value) return;
  widget.setProperty(name, value);
  widget.style()->unpolish(&widget);
  widget.style()->polish(&widget);
}

}  // namespace cnc::gui
