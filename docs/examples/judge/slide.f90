! A rigid block that slides down a slope steeper than its friction, in closed form.
program slide
  implicit none
  integer, parameter :: dp = kind(1d0)
  real(dp) :: slope = 0, friction = -1, gravity = 0, dt = 0, rate
  integer :: steps = 0, n, status
  character(200) :: line, key, text
  do
    read (*, '(a)', iostat=status) line
    if (status /= 0) exit
    read (line, *) key, text
    select case (key)
    case ('load.slope_deg');           read (text, *) slope
    case ('load.gravity_m_per_s2');    read (text, *) gravity
    case ('contact.friction_deg');     read (text, *) friction
    case ('time.step_s');              read (text, *) dt
    case ('time.steps');               read (text, *) steps
    case ('also', 'column.motion');    friction = -1; exit
    end select
  end do
  if (friction < 0 .or. slope <= friction) then
    write (0, *) 'a block that slides only'
    stop 77
  end if
  rate = gravity * (sin(rad(slope)) - tan(rad(friction)) * cos(rad(slope)))
  print '(a)', 'time_s,horizontal_displacement_m'
  do n = 1, steps
    print '(es24.16, ",", es24.16)', n * dt, rate * (n * dt)**2 / 2
  end do
contains
  real(dp) function rad(degrees)
    real(dp), intent(in) :: degrees
    rad = degrees * acos(-1d0) / 180
  end function
end program
