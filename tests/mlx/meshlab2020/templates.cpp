// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps scripts/<slug>.mlx and the filters of the built plugins equal.
//   templates check <scripts folder> <plugin>...   fails where one differs
//   templates write <scripts folder> <plugin>...   writes them anew
#include <common/filterscript.h>
#include <common/interfaces.h>

#include <QApplication>
#include <QDir>
#include <QDomDocument>
#include <QFile>
#include <QPluginLoader>
#include <QRegularExpression>
#include <QTextStream>
#include <iostream>

namespace {

/// Attributes in a reader's order; QDomDocument's own order is random.
QString to_line(const QDomElement& param) {
  QStringList names = {"type", "name", "value", "x", "y", "z", "min", "max", "enum_cardinality"};
  for (int i = 0; i < param.attribute("enum_cardinality", "0").toInt(); ++i) names << "enum_val" + QString::number(i);
  const QDomNamedNodeMap attributes = param.attributes();
  for (const QString last : {"description", "tooltip"}) {
    QStringList rest;
    for (int i = 0; i < attributes.count(); ++i) {
      const QString name = attributes.item(i).nodeName();
      if (!names.contains(name) && name != "description" && name != "tooltip") rest << name;
    }
    rest.sort();
    names << rest << last;
  }
  QString line = "  <Param";
  for (const QString& name : names)
    if (param.hasAttribute(name)) line += " " + name + "=\"" + param.attribute(name).toHtmlEscaped() + "\"";
  return line + "/>";
}

QStringList to_lines(const RichParameterList& list) {
  QDomDocument document;
  QStringList lines;
  for (const RichParameter& parameter : list) lines << to_line(parameter.fillToXMLDocument(document));
  return lines;
}

QString script_of(const QString& filter, const QStringList& parameters) {
  return "<!DOCTYPE FilterScript>\n<FilterScript>\n <filter name=\"" + filter.toHtmlEscaped() + "\">\n" +
         parameters.join("\n") + "\n </filter>\n</FilterScript>\n";
}

bool write(const QString& path, const QString& script) {
  QFile file(path);
  if (!file.open(QIODevice::WriteOnly)) return false;
  return file.write(script.toUtf8()) >= 0;
}

/// Compares through the host's own reader of scripts.
int check(const QString& path, const QString& filter, const QStringList& declared) {
  FilterScript script;
  if (!script.open(path) || script.size() != 1) {
    std::cerr << qPrintable(path) << ": is missing or is not a script of one filter\n";
    return 1;
  }
  int failures = 0;
  if (script[0].first != filter) {
    std::cerr << qPrintable(path) << ": names the filter " << qPrintable(script[0].first) << ", not "
              << qPrintable(filter) << "\n";
    ++failures;
  }
  // The host's reader drops the endings of files to open.
  const QRegularExpression endings(" ext_val\\d+=\"[^\"]*\"");
  const QStringList found = to_lines(script[0].second).replaceInStrings(endings, ""),
                    expected = QStringList(declared).replaceInStrings(endings, "");
  for (int i = 0; i < std::max(found.size(), expected.size()); ++i) {
    if (found.value(i) == expected.value(i)) continue;
    std::cerr << qPrintable(path) << ": parameter " << i + 1 << " differs\n  script: " << qPrintable(found.value(i))
              << "\n  filter: " << qPrintable(expected.value(i)) << "\n";
    ++failures;
  }
  return failures;
}

}  // namespace

int main(int argc, char** argv) {
  qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication application(argc, argv);
  const QStringList arguments = application.arguments();
  if (arguments.size() < 4 || (arguments[1] != "check" && arguments[1] != "write")) {
    std::cerr << "usage: templates check|write <scripts folder> <plugin>...\n";
    return 2;
  }
  const QDir folder(arguments[2]);
  QStringList orphans = folder.entryList({"*.mlx"}, QDir::Files);
  int failures = 0, filters = 0;
  // Two empty layers: the document in which the templates' defaults hold.
  MeshDocument document;
  document.addNewMesh("", "A");
  document.addNewMesh("", "B", false);
  for (const QString& file : arguments.mid(3)) {
    QPluginLoader loader(QFileInfo(file).absoluteFilePath());
    auto* plugin = qobject_cast<MeshFilterInterface*>(loader.instance());
    if (!plugin) {
      std::cerr << qPrintable(file) << ": " << qPrintable(loader.errorString()) << "\n";
      return 1;
    }
    for (QAction* action : plugin->actions()) {
      const int id = plugin->ID(action);
      const QString name = plugin->filterScriptFunctionName(id) + ".mlx";
      RichParameterList list;
      plugin->initParameterSet(action, document, list);
      orphans.removeAll(name);
      ++filters;
      if (arguments[1] == "write")
        failures += !write(folder.filePath(name), script_of(plugin->filterName(id), to_lines(list)));
      else
        failures += check(folder.filePath(name), plugin->filterName(id), to_lines(list));
    }
  }
  for (const QString& name : orphans) std::cerr << qPrintable(name) << ": belongs to no filter\n";
  failures += orphans.size();
  std::cout << filters << " filters, " << failures << " differences\n";
  if (failures) std::cerr << "The target 'write_templates' writes them anew.\n";
  return failures ? 1 : 0;
}
