/** What panels of tools ask of the server. */

/**
 * Asks for an operation; an error is told in a notice. A panel that was closed meanwhile hears of
 * neither.
 * @param {{app: any, closed?: boolean}} panel
 * @param {string} op
 * @param {Object} fields
 * @param {(result: any) => void} [then] what to do with the answer
 */
export async function ask(panel, op, fields, then = () => {}) {
  try {
    const result = await panel.app.connection.request(op, fields);
    if (!panel.closed) then(result);
  } catch (error) {
    if (!panel.closed) panel.app.notify(error.message, "bad");
  }
}
