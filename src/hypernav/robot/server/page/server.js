// Requests to the server: its token, and whether it answers.

const TOKEN_KEY = "hypernav-token";
const TIMEOUT_MS = 8000;

/** A request that the server refused; `message` is meant for people. */
export class Refused extends Error {
  constructor(status, body) {
    super(body?.message ?? `the server answered with status ${status}`);
    this.status = status;
  }
}

/** Sends "on", "off" or "token" as `state` events, whenever that changes. */
class Connection extends EventTarget {
  state = "connecting";

  enter(state) {
    if (state === this.state) return;
    this.state = state;
    this.dispatchEvent(new Event("state"));
  }
}

export const connection = new Connection();

export function rememberToken(token) {
  sessionStorage.setItem(TOKEN_KEY, token);
}

export const hasToken = () => sessionStorage.getItem(TOKEN_KEY) !== null;

/** A response of the server. Throws `Refused`, or a `TypeError` where the server can't be reached. */
export async function request(path, { method = "GET", body, waitMs = 0, signal } = {}) {
  const headers = {};
  const token = sessionStorage.getItem(TOKEN_KEY);
  if (token) headers.authorization = `Bearer ${token}`;
  if (body !== undefined) headers["content-type"] = "application/json";
  const limits = [AbortSignal.timeout(waitMs + TIMEOUT_MS)];
  if (signal) limits.push(signal);
  let response;
  try {
    response = await fetch(path, {
      method, headers, body: body === undefined ? undefined : JSON.stringify(body),
      cache: "no-store", signal: anyOf(limits),
    });
  } catch (error) {
    if (!signal?.aborted) connection.enter("off");
    throw error;
  }
  connection.enter(response.status === 401 ? "token" : "on");
  if (!response.ok) throw new Refused(response.status, await response.json().catch(() => null));
  return response;
}

export const getJson = async (path, options) => parse(await (await request(path, options)).text());

// Control characters and changes of the reading direction are made visible.
const OBEYED = /[\u0000-\u0009\u000b-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/g;
const escaped = (sign) => `\\u${sign.charCodeAt(0).toString(16).padStart(4, "0")}`;

/** JSON of the server, whose texts may come from outside. */
export const parse = (text) => JSON.parse(text, (_, value) => (typeof value === "string" ? value.replace(OBEYED, escaped) : value));
export const post = (path, body) => getJson(path, { method: "POST", body });

export const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** `AbortSignal.any`, which phones of 2023 don't have. */
function anyOf(signals) {
  if (AbortSignal.any) return AbortSignal.any(signals);
  const either = new AbortController();
  for (const one of signals) {
    if (one.aborted) either.abort(one.reason);
    one.addEventListener("abort", () => either.abort(one.reason), { once: true });
  }
  return either.signal;
}
