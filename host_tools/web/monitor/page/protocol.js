// Messages of the monitor; host_tools/web/monitor/page_messages.h describes them.

const kTableNames = { 1: 'ticks', 2: 'planner', 3: 'plan', 4: 'truth' };
const kTableHead_bytes = 24;

/** Decodes a binary message: {name, base_s, first, rows, width, values}, values row by row. */
function decodeTable(buffer, columns) {
  const view = new DataView(buffer);
  const name = kTableNames[view.getUint8(0)];
  const rows = view.getUint32(4, true);
  const width = columns[name].length;
  return {
    name, rows, width,
    base_s: view.getFloat64(8, true),
    first: view.getFloat64(16, true),
    values: new Float32Array(buffer, kTableHead_bytes, rows * width),
  };
}

/** The connection to the monitor. It is opened again when it is lost. */
class Connection {
  /** `listener`: {opened(), closed(), text(message), table(table)}. */
  constructor(listener) {
    this.listener = listener;
    this.columns = null;
    this.open();
  }

  open() {
    const scheme = window.location.protocol === 'https:' ? 'wss' : 'ws';
    const socket = new WebSocket(`${scheme}://${window.location.host}/live`);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.onopen = () => this.listener.opened();
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = () => {
      this.columns = null;
      this.listener.closed();
      setTimeout(() => this.open(), 500);
    };
  }

  receive(data) {
    if (typeof data !== 'string') {
      if (this.columns) this.listener.table(decodeTable(data, this.columns));
      return;
    }
    const message = JSON.parse(data);
    if (message.type === 'hello') this.columns = message.columns;
    this.listener.text(message);
  }

  /** False when the monitor is not there. */
  send(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }
}
