// SPDX-License-Identifier: GPL-3.0-or-later
// That scripts/<slug>.mlx, which are written by the host of 2020, hold every
// parameter of the filters of the built plugins with its default.
//   templates check <scripts folder> <plugin>...   fails where one differs
#include <common/filterscript.h>
#include <common/ml_document/mesh_document.h>
#include <common/plugins/interfaces/filter_plugin.h>

#include <QApplication>
#include <QDir>
#include <QDomDocument>
#include <QPluginLoader>
#include <iostream>
#include <map>

namespace {

/// A parameter's value as a script has it.
QString value_of(const RichParameter& parameter) {
  QDomDocument document;
  const QDomElement element = parameter.fillToXMLDocument(document);
  QStringList values;
  for (const char* name : {"value", "x", "y", "z"})
    if (element.hasAttribute(name)) values << element.attribute(name);
  return values.join(" ");
}

std::map<QString, QString> values_of(const RichParameterList& list) {
  std::map<QString, QString> values;
  for (const RichParameter& p : list) values[p.name()] = p.value().typeName() + " " + value_of(p);
  return values;
}

/// How many parameters of a script are not the filter's.
int differences(const QString& path, const RichParameterList& script, const RichParameterList& declared) {
  const std::map<QString, QString> found = values_of(script), expected = values_of(declared);
  int count = 0;
  for (const auto& [name, value] : expected) {
    const auto given = found.find(name);
    if (given != found.end() && given->second == value) continue;
    std::cerr << qPrintable(path) << ": " << qPrintable(name) << " is "
              << (given == found.end() ? "missing" : qPrintable(given->second)) << ", not " << qPrintable(value)
              << "\n";
    ++count;
  }
  for (const auto& given : found)
    if (!expected.count(given.first))
      std::cerr << qPrintable(path) << ": no " << qPrintable(given.first) << "\n", ++count;
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication application(argc, argv);
  const QStringList arguments = application.arguments();
  if (arguments.size() < 4 || arguments[1] != "check") {
    std::cerr << "usage: templates check <scripts folder> <plugin>...\nThey are written on the host of 2020.\n";
    return 2;
  }
  std::map<QString, std::pair<QString, RichParameterList>> scripts;  // by the filter's name
  const QDir folder(arguments[2]);
  for (const QString& name : folder.entryList({"*.mlx"}, QDir::Files)) {
    FilterScript script;
    if (script.open(folder.filePath(name)) && script.size() == 1) scripts[script[0].first] = {name, script[0].second};
  }
  int failures = 0, filters = 0;
  MeshDocument document;  // two empty layers: where the templates' defaults hold
  document.addNewMesh("", "A");
  document.addNewMesh("", "B", false);
  for (const QString& file : arguments.mid(3)) {
    QPluginLoader loader(QFileInfo(file).absoluteFilePath());
    auto* plugin = qobject_cast<FilterPlugin*>(loader.instance());
    if (!plugin) {
      std::cerr << qPrintable(file) << ": " << qPrintable(loader.errorString()) << "\n";
      return 1;
    }
    for (QAction* action : plugin->actions()) {
      ++filters;
      const QString name = plugin->filterName(action);
      if (!scripts.count(name))
        std::cerr << "No template has the filter " << qPrintable(name) << "\n", ++failures;
      else
        failures += differences(scripts[name].first, scripts[name].second, plugin->initParameterList(action, document));
      scripts.erase(name);
    }
  }
  for (const auto& rest : scripts) std::cerr << qPrintable(rest.second.first) << ": belongs to no filter\n";
  failures += int(scripts.size());
  std::cout << filters << " filters, " << failures << " differences\n";
  return failures ? 1 : 0;
}
