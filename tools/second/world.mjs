// The laws of flight, meeting and impulse, in any arithmetic (Forms or Balls).

/** Circles and walls of a scene, their flights, and the times of the instants, in one arithmetic. */
export class World {
  constructor(scene, ring) {
    this.scene = scene
    this.ring = ring
    const { of } = { of: (x) => ring.of(x) }
    this.circles = scene.circles.map(({ r, w }) => ({ r: of(r), w: of(w) }))
    this.walls = scene.walls.map((wall) => ({
      x: of(wall.x), y: of(wall.y), nx: of(wall.nx), ny: of(wall.ny), length: of(wall.length),
    }))
    this.pockets = scene.pockets.map(({ x, y, r }) => ({ x: of(x), y: of(y), r: of(r) }))
    this.flights = scene.circles.map(({ x, y, vx, vy }) => ({ x: of(x), y: of(y), vx: of(vx), vy: of(vy), age: 0 }))
    this.times = [ring.zero]
    this.limits = new Map([...scene.limits].map(([name, x]) => [name, of(x)]))
  }

  /** The flight of circle i, told from where it is at an instant. */
  put(i, age) {
    const flight = this.flights[i]
    if (flight.age === age) return flight
    const { ring } = this
    const wait = ring.sub(this.times[age], this.times[flight.age])
    const { x, y, vx, vy } = flight
    return { x: ring.add(x, ring.mul(vx, wait)), y: ring.add(y, ring.mul(vy, wait)), vx, vy, age }
  }

  /** The later start of the flights of a contact. */
  start([i, j]) {
    const { age } = this.flights[i]
    return j >= 0 && j < this.scene.n ? Math.max(age, this.flights[j].age) : age
  }

  dot(a, b, c, d) {
    return this.ring.add(this.ring.mul(a, c), this.ring.mul(b, d))
  }

  /** Two at an instant: gap, closing and speed, so that the gap s later is gap + 2 closing s + speed s^2. */
  meeting(contact, age) {
    const [i, j] = contact
    const { ring, scene } = this
    const a = this.put(i, age)
    if (j >= scene.n) {
      const wall = this.walls[j - scene.n]
      const side = scene.side(contact)
      const [nx, ny] = side > 0 ? [wall.nx, wall.ny] : [ring.neg(wall.nx), ring.neg(wall.ny)]
      const gap = ring.sub(
        this.dot(nx, ny, ring.sub(a.x, wall.x), ring.sub(a.y, wall.y)),
        ring.mul(this.circles[i].r, wall.length),
      )
      const closing = this.dot(nx, ny, a.vx, a.vy)
      return { gap: ring.twice(gap), closing, speed: ring.zero, disc: () => ring.mul(closing, closing), arms: [[i, nx, ny]] }
    }
    const pocket = j < 0 ? this.pockets[-1 - j] : null
    const b = pocket ? { x: pocket.x, y: pocket.y, vx: ring.zero, vy: ring.zero } : this.put(j, age)
    const reach = pocket ? pocket.r : ring.add(this.circles[i].r, this.circles[j].r)
    const [x, y] = [ring.sub(b.x, a.x), ring.sub(b.y, a.y)]
    const [vx, vy] = [ring.sub(b.vx, a.vx), ring.sub(b.vy, a.vy)]
    const square = ring.mul(reach, reach)
    const speed = this.dot(vx, vy, vx, vy)
    const disc = () => {
      const cross = ring.sub(ring.mul(x, vy), ring.mul(y, vx))
      return ring.sub(ring.mul(speed, square), ring.mul(cross, cross))
    }
    const arms = [[i, ring.neg(x), ring.neg(y)], [j, x, y]]
    return { gap: ring.sub(this.dot(x, y, x, y), square), closing: this.dot(x, y, vx, vy), speed, disc, arms }
  }

  /** When the gap of two falls through zero. */
  hit(contact) {
    const { ring } = this
    const start = this.start(contact)
    const m = this.meeting(contact, start)
    return ring.add(this.times[start], ring.div(m.gap, ring.sub(ring.sqrt(m.disc()), m.closing)))
  }

  /** x with G x = y, by elimination; each row is one of G and, last, of y. */
  solve(rows) {
    const { ring } = this
    const n = rows.length
    const g = rows.map((row) => [...row])
    for (let k = 0; k < n; k++) {
      for (let i = k + 1; i < n; i++) {
        const factor = ring.div(g[i][k], g[k][k])
        for (let j = k + 1; j <= n; j++) g[i][j] = ring.sub(g[i][j], ring.mul(factor, g[k][j]))
      }
    }
    const x = new Array(n)
    for (let k = n - 1; k >= 0; k--) {
      let rest = g[k][n]
      for (let j = k + 1; j < n; j++) rest = ring.sub(rest, ring.mul(g[k][j], x[j]))
      x[k] = ring.div(rest, g[k][k])
    }
    return x
  }

  /** A round: impulses, told or by G s = -2u; 2u + G s of `push` and `others`, in this order, is kept in `rest`. */
  blow(age, push, others, told) {
    const { ring } = this
    const met = [...push, ...others].map((contact) => this.meeting(contact, age))
    const effect = (a, b) => {
      let sum = ring.zero
      for (const [i, x, y] of met[a].arms) {
        for (const [k, u, v] of met[b].arms) {
          if (i === k) sum = ring.add(sum, ring.mul(this.circles[i].w, this.dot(x, y, u, v)))
        }
      }
      return sum
    }
    const twice = met.map((m) => ring.twice(m.closing))
    const s = told.length
      ? told.map((x) => ring.of(x))
      : this.solve(push.map((_, a) => [...push.map((__, b) => effect(a, b)), ring.neg(twice[a])]))
    this.rest = met.map((_, a) => s.reduce((sum, j, b) => ring.add(sum, ring.mul(effect(a, b), j)), twice[a]))
    push.forEach((_, a) => {
      for (const [i, x, y] of met[a].arms) {
        const flight = this.put(i, age)
        const j = ring.mul(this.circles[i].w, s[a])
        const [vx, vy] = [ring.add(flight.vx, ring.mul(j, x)), ring.add(flight.vy, ring.mul(j, y))]
        this.flights[i] = { ...flight, vx, vy, age }
      }
    })
    return s
  }

  /** Ends flights at an instant, and lets circles go on with other velocities. */
  redirect(circles, age, change) {
    for (const i of circles) {
      const { x, y, vx, vy } = this.put(i, age)
      this.flights[i] = { x, y, vx: change(this.ring, vx), vy: change(this.ring, vy), age }
    }
  }
}
