// Starts the language server of jausml; all that is known of the language lies there.

const { workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

function activate() {
  const command = workspace.getConfiguration("ros2jaus").get("command", "jausml");
  client = new LanguageClient(
    "ros2jaus",
    "ros2jaus",
    { command, args: ["language-server"] },
    { documentSelector: [{ language: "ros2jaus" }] },
  );
  return client.start();
}

function deactivate() {
  return client === undefined ? undefined : client.stop();
}

module.exports = { activate, deactivate };
