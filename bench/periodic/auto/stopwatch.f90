! How long AUTO-07p iterates, and what it finds with all digits: its own files hold eleven.
module stopwatch
  implicit none
  private
  public :: resume, report
  logical :: running = .false.
  double precision :: last = 0
  double precision :: began
contains

  ! Called at each evaluation; the first one after a report starts the clock, so that meshes and files are
  ! left out.
  subroutine resume()
    if (running) return
    running = .true.
    call cpu_time(began)
  end subroutine resume

  ! Called with the start, each solution, and where the iteration fails with the one before again: then the
  ! parameter that AUTO continues in, first of all, is what it was. Appends to `solutions` seconds, intervals,
  ! degree and period, the lengths of the intervals over the period, and degree*intervals + 1 states, equally
  ! spaced in each interval.
  subroutine report(ndim, u, par)
    integer, intent(in) :: ndim
    double precision, intent(in) :: u(ndim, 0:*), par(*)
    double precision, external :: getp
    double precision :: now
    integer :: unit, intervals, degree, i
    call cpu_time(now)
    if (.not. running) return
    running = .false.
    if (par(1) == last) return
    last = par(1)
    intervals = nint(getp('NTST', 0, u))
    degree = nint(getp('NCOL', 0, u))
    open (newunit=unit, file='solutions', position='append')
    write (unit, '(es26.16e3, 2i8, es26.16e3)') now - began, intervals, degree, par(11)
    write (unit, '(*(es26.16e3))') (getp('DTM', i, u), i=1, intervals)
    do i = 0, intervals*degree
      write (unit, '(*(es26.16e3))') u(:, i)
    end do
    close (unit)
  end subroutine report
end module stopwatch

subroutine pvls(ndim, u, par)
  use stopwatch, only: report
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(in) :: u(ndim, *)
  double precision, intent(inout) :: par(*)
  call report(ndim, u, par)
end subroutine pvls

! What AUTO wants besides: the start is read from a file, nothing is integrated or optimised.
subroutine stpnt
end subroutine stpnt

subroutine icnd
end subroutine icnd

subroutine fopt
end subroutine fopt
